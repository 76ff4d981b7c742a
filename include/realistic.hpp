/* realistic.hpp: realistic.h with owners and exceptions, for C++11 and later. MIT OR Apache-2.0.
 *
 *     realistic::Options options(640, 480);
 *     options.set(&realistic_options::specfile, "wide.22mm").set(&realistic_options::fnumber, 8);
 *     realistic::Camera camera(options);
 *     float weight = camera.generate(sample, ray);
 *
 * Header only. A program either links against the library, or loads it and says where the functions
 * are: realistic::Api::find([&](const char *name) { return dlsym(library, name); }), passed to Options;
 * the library then stays loaded for as long as a camera lives. */

#ifndef REALISTIC_HPP
#define REALISTIC_HPP

#include "realistic.h"

#include <cstring>
#include <exception>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace realistic {

/* A call that failed: the library's own words, and its status. */
class Error : public std::runtime_error {
public:
    Error(realistic_status status, const std::string &message) : std::runtime_error(message), status_(status) {}

    realistic_status status() const noexcept { return status_; }

private:
    realistic_status status_;
};

/* The library's functions, linked or found in a loaded library. */
struct Api {
    decltype(&realistic_last_error) last_error;
    decltype(&realistic_options_init) options_init;
    decltype(&realistic_camera_new) camera_new;
    decltype(&realistic_camera_free) camera_free;
    decltype(&realistic_camera_get_info) camera_get_info;
    decltype(&realistic_camera_get_lens_name) camera_get_lens_name;
    decltype(&realistic_camera_plan) camera_plan;
    decltype(&realistic_generate_ray) generate_ray;
    decltype(&realistic_camera_generate_rays) camera_generate_rays;
    decltype(&realistic_camera_generate_rays_soa) camera_generate_rays_soa;
    decltype(&realistic_generate_ray_differential) generate_ray_differential;
    decltype(&realistic_camera_generate_ray_differentials) camera_generate_ray_differentials;
    decltype(&realistic_camera_generate_ray_differentials_soa) camera_generate_ray_differentials_soa;

    /* Those that the program is linked with. A program that only loads the library never calls this. */
    static Api linked() {
        require_version(realistic_abi_version());
        return Api{realistic_last_error,         realistic_options_init,
                   realistic_camera_new,         realistic_camera_free,
                   realistic_camera_get_info,    realistic_camera_get_lens_name,
                   realistic_camera_plan,        realistic_generate_ray,
                   realistic_camera_generate_rays, realistic_camera_generate_rays_soa,
                   realistic_generate_ray_differential, realistic_camera_generate_ray_differentials,
                   realistic_camera_generate_ray_differentials_soa};
    }

    /* Those that `symbol`, called with each name, returns as void pointers. Throws Error when one is missing
     * or the library is older than this header. */
    template <class Symbol> static Api find(Symbol symbol) {
        decltype(&realistic_abi_version) version;
        resolve(symbol, "realistic_abi_version", version);
        require_version(version());
        Api api;
        resolve(symbol, "realistic_last_error", api.last_error);
        resolve(symbol, "realistic_options_init", api.options_init);
        resolve(symbol, "realistic_camera_new", api.camera_new);
        resolve(symbol, "realistic_camera_free", api.camera_free);
        resolve(symbol, "realistic_camera_get_info", api.camera_get_info);
        resolve(symbol, "realistic_camera_get_lens_name", api.camera_get_lens_name);
        resolve(symbol, "realistic_camera_plan", api.camera_plan);
        resolve(symbol, "realistic_generate_ray", api.generate_ray);
        resolve(symbol, "realistic_camera_generate_rays", api.camera_generate_rays);
        resolve(symbol, "realistic_camera_generate_rays_soa", api.camera_generate_rays_soa);
        resolve(symbol, "realistic_generate_ray_differential", api.generate_ray_differential);
        resolve(symbol, "realistic_camera_generate_ray_differentials", api.camera_generate_ray_differentials);
        resolve(symbol, "realistic_camera_generate_ray_differentials_soa",
                api.camera_generate_ray_differentials_soa);
        return api;
    }

    /* Throws a failed call's message. */
    void check(realistic_status status) const {
        if (status != REALISTIC_STATUS_OK) throw Error(status, last_error());
    }

private:
    static void require_version(uint32_t found) {
        if (found < REALISTIC_ABI_VERSION) {
            throw Error(REALISTIC_STATUS_UNSUPPORTED, "the library's ABI version " + std::to_string(found) +
                                                          " is older than this program's, " +
                                                          std::to_string(REALISTIC_ABI_VERSION));
        }
    }

    template <class Symbol, class Function>
    static void resolve(Symbol &symbol, const char *name, Function &function) {
        void *found = symbol(name);
        if (found == nullptr) {
            throw Error(REALISTIC_STATUS_UNSUPPORTED, std::string("the library has no function ") + name);
        }
        static_assert(sizeof found == sizeof function, "code and data have addresses of one size");
        std::memcpy(&function, &found, sizeof function);
    }
};

/* What a camera is built from; owns its strings. What is not set keeps the library's default. */
class Options {
public:
    /* Gets level (0 information, 1 warning, 2 error) and message while a camera is being built. What it
     * throws comes out of Camera's constructor. */
    using Log = std::function<void(int32_t, const char *)>;

    Options(int32_t xres, int32_t yres) : Options(xres, yres, Api::linked()) {}

    Options(int32_t xres, int32_t yres, const Api &api) : api_(api) {
        api_.check(api_.options_init(&raw_, sizeof raw_));
        raw_.xres = xres;
        raw_.yres = yres;
    }

    /* A number by its member: set(&realistic_options::fnumber, 8). */
    Options &set(double realistic_options::*member, double value) {
        raw_.*member = value;
        return *this;
    }

    /* A string by its member: set(&realistic_options::specfile, "wide.22mm"). */
    Options &set(const char *realistic_options::*member, const std::string &value) {
        raw_.*member = keep(value);
        return *this;
    }

    /* The text of a lens file, instead of `specfile`. */
    Options &lens_text(const std::string &text) {
        raw_.lens_text = keep(text);
        raw_.lens_text_size = text.size();
        return *this;
    }

    Options &simpleweighting(bool value) {
        raw_.simpleweighting = value ? 1 : 0;
        return *this;
    }

    /* Row-major, for column vectors. */
    Options &camera_to_world(const float (&rows)[16]) {
        std::memcpy(raw_.camera_to_world, rows, sizeof raw_.camera_to_world);
        return *this;
    }

    Options &log(Log log) {
        log_ = std::move(log);
        return *this;
    }

    const realistic_options &raw() const noexcept { return raw_; }

private:
    friend class Camera;

    const char *keep(const std::string &value) {
        /* Each string lies in a box of its own, so that the options can move. */
        strings_.emplace_back(new std::string(value));
        return strings_.back()->c_str();
    }

    Api api_;
    realistic_options raw_;
    Log log_;
    std::vector<std::unique_ptr<std::string>> strings_;
};

/* A camera, freed with this object. Can be moved, not copied; any number of threads may ask it for rays. */
class Camera {
public:
    /* Throws Error with the reason, and what to change. */
    explicit Camera(const Options &options) : api_(options.api_), camera_(nullptr, options.api_.camera_free) {
        Listener listener{options.log_, nullptr};
        realistic_options raw = options.raw_;
        if (options.log_) {
            raw.log = listen;
            raw.log_user = &listener;
        }
        realistic_camera *camera = nullptr;
        realistic_status status = api_.camera_new(&raw, &camera);
        camera_.reset(camera);
        if (listener.thrown) std::rethrow_exception(listener.thrown);
        api_.check(status);
    }

    /* The weight of a ray; 0, and the ray as it was, where the lens blocks it. */
    float generate(const realistic_sample &sample, realistic_ray &ray) const noexcept {
        return api_.generate_ray(camera_.get(), &sample, &ray);
    }

    /* As `generate` for `n` samples; `reasons` may be NULL. Strides are in bytes, 0 for tightly packed. */
    void generate(const realistic_sample *samples, std::size_t n, realistic_ray *rays, float *weights,
                  realistic_reason *reasons = nullptr, std::size_t sample_stride = 0,
                  std::size_t ray_stride = 0) const {
        api_.check(api_.camera_generate_rays(camera_.get(), n, samples, sample_stride, rays, ray_stride,
                                             weights, reasons));
    }

    /* As structure of arrays, of `n` elements each. */
    void generate(const realistic_samples_soa &samples, std::size_t n, const realistic_rays_soa &rays) const {
        api_.check(api_.camera_generate_rays_soa(camera_.get(), n, &samples, &rays));
    }

    /* The weight of a ray with differentials, whose `struct_size` is set here; 0, and the rest as it was, where the
     * lens blocks it. */
    float generate(const realistic_sample &sample, realistic_ray_differential &ray) const noexcept {
        ray.struct_size = sizeof ray;
        return api_.generate_ray_differential(camera_.get(), &sample, &ray);
    }

    /* As `generate` for `n` samples, with differentials; sets `struct_size` of the first of `rays`. */
    void generate(const realistic_sample *samples, std::size_t n, realistic_ray_differential *rays, float *weights,
                  realistic_reason *reasons = nullptr, std::size_t sample_stride = 0,
                  std::size_t ray_stride = 0) const {
        if (n > 0 && rays != nullptr) rays->struct_size = sizeof *rays;
        api_.check(api_.camera_generate_ray_differentials(camera_.get(), n, samples, sample_stride, rays, ray_stride,
                                                          weights, reasons));
    }

    /* As structure of arrays with differentials, of `n` elements each. */
    void generate(const realistic_samples_soa &samples, std::size_t n, const realistic_rays_soa &rays,
                  const realistic_rays_soa &rx, const realistic_rays_soa &ry) const {
        api_.check(api_.camera_generate_ray_differentials_soa(camera_.get(), n, &samples, &rays, &rx, &ry));
    }

    realistic_camera_info info() const {
        realistic_camera_info info;
        info.struct_size = sizeof info;
        api_.check(api_.camera_get_info(camera_.get(), &info));
        return info;
    }

    std::string lens_name() const { return text(api_.camera_get_lens_name); }

    /* What the camera keeps and leaves out, and which model of the lens a tolerance chose: lines for people. */
    std::string plan() const { return text(api_.camera_plan); }

    /* The handle for realistic.h's functions, still owned here; NULL once moved from. */
    const realistic_camera *get() const noexcept { return camera_.get(); }

    /* Gives the handle away: realistic_camera_free is the caller's from now on. */
    realistic_camera *release() noexcept { return camera_.release(); }

private:
    template <class Function> std::string text(Function function) const {
        std::size_t length = 0;
        api_.check(function(camera_.get(), nullptr, 0, &length));
        std::vector<char> buffer(length + 1);
        api_.check(function(camera_.get(), buffer.data(), buffer.size(), nullptr));
        return std::string(buffer.data(), length);
    }

    struct Listener {
        const Options::Log &log;
        std::exception_ptr thrown;
    };

    /* An exception must not fly through the library: it waits until the call is over. */
    static void listen(void *user, int32_t level, const char *message) {
        Listener &listener = *static_cast<Listener *>(user);
        if (listener.thrown) return;
        try {
            listener.log(level, message);
        } catch (...) {
            listener.thrown = std::current_exception();
        }
    }

    Api api_;
    std::unique_ptr<realistic_camera, decltype(&realistic_camera_free)> camera_;
};

} // namespace realistic

#endif /* REALISTIC_HPP */
