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

#include <cmath>
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
    decltype(&realistic_autofocus) autofocus;
    decltype(&realistic_capabilities) capabilities;
    decltype(&realistic_lens_new) lens_new;
    decltype(&realistic_lens_free) lens_free;
    decltype(&realistic_lens_get_info) lens_get_info;
    decltype(&realistic_lens_get_surface) lens_get_surface;
    decltype(&realistic_lens_get_name) lens_get_name;
    decltype(&realistic_lens_focus) lens_focus;
    decltype(&realistic_lens_focused_on) lens_focused_on;
    decltype(&realistic_lens_trace) lens_trace;
    decltype(&realistic_camera_importance) camera_importance;
    decltype(&realistic_camera_sample_importance) camera_sample_importance;

    /* Those that the program is linked with. A program that only loads the library never calls this. */
    static Api linked() {
        require_version(realistic_abi_version());
        return Api{realistic_last_error,         realistic_options_init,
                   realistic_camera_new,         realistic_camera_free,
                   realistic_camera_get_info,    realistic_camera_get_lens_name,
                   realistic_camera_plan,        realistic_generate_ray,
                   realistic_camera_generate_rays, realistic_camera_generate_rays_soa,
                   realistic_generate_ray_differential, realistic_camera_generate_ray_differentials,
                   realistic_camera_generate_ray_differentials_soa,
                   realistic_autofocus,          realistic_capabilities,
                   realistic_lens_new,           realistic_lens_free,
                   realistic_lens_get_info,      realistic_lens_get_surface,
                   realistic_lens_get_name,      realistic_lens_focus,
                   realistic_lens_focused_on,    realistic_lens_trace,
                   realistic_camera_importance,  realistic_camera_sample_importance};
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
        resolve(symbol, "realistic_autofocus", api.autofocus);
        resolve(symbol, "realistic_capabilities", api.capabilities);
        resolve(symbol, "realistic_lens_new", api.lens_new);
        resolve(symbol, "realistic_lens_free", api.lens_free);
        resolve(symbol, "realistic_lens_get_info", api.lens_get_info);
        resolve(symbol, "realistic_lens_get_surface", api.lens_get_surface);
        resolve(symbol, "realistic_lens_get_name", api.lens_get_name);
        resolve(symbol, "realistic_lens_focus", api.lens_focus);
        resolve(symbol, "realistic_lens_focused_on", api.lens_focused_on);
        resolve(symbol, "realistic_lens_trace", api.lens_trace);
        resolve(symbol, "realistic_camera_importance", api.camera_importance);
        resolve(symbol, "realistic_camera_sample_importance", api.camera_sample_importance);
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

/* What a camera or a lens is made from; owns its strings. What is not set keeps the library's default. */
class Options {
public:
    /* Gets level (0 information, 1 warning, 2 error) and message while a camera or a lens is being made. What it
     * throws comes out of the constructor. */
    using Log = std::function<void(int32_t, const char *)>;

    Options(int32_t xres, int32_t yres) : Options(xres, yres, Api::linked()) {}

    /* Of a lens, which has no film. */
    Options() : Options(0, 0) {}
    explicit Options(const Api &api) : Options(0, 0, api) {}

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

    /* Zones of the picture in, the film distance in mm out: see realistic_autofocus. One of the two callbacks is
     * given: `distance` gets a ray and returns how far along it the first surface is, `contrast` gets a camera, not to
     * be kept, and a zone. What they throw comes out of here. */
    double autofocus(const std::vector<realistic_zone> &zones, realistic_autofocus_rule rule,
                     std::function<double(const realistic_ray &)> distance,
                     std::function<double(const realistic_camera *, const realistic_zone &)> contrast = nullptr) const {
        Zones asked{distance, contrast, nullptr};
        double film_distance = 0;
        realistic_status status = listened(*this, [&](const realistic_options *raw) {
            return api_.autofocus(raw, zones.data(), zones.size(), rule, distance ? Zones::ask_distance : nullptr,
                                  contrast ? Zones::ask_contrast : nullptr, &asked, &film_distance);
        });
        if (asked.thrown) std::rethrow_exception(asked.thrown);
        api_.check(status);
        return film_distance;
    }

private:
    friend class Camera;
    friend class Lens;

    const char *keep(const std::string &value) {
        /* Each string lies in a box of its own, so that the options can move. */
        strings_.emplace_back(new std::string(value));
        return strings_.back()->c_str();
    }

    /* A text that a function copies into a buffer. */
    template <class Function, class Handle>
    static std::string text(const Api &api, Function function, const Handle *handle) {
        std::size_t length = 0;
        api.check(function(handle, nullptr, 0, &length));
        std::vector<char> buffer(length + 1);
        api.check(function(handle, buffer.data(), buffer.size(), nullptr));
        return std::string(buffer.data(), length);
    }

    /* Calls with the options, their log in place, and throws what that threw. An exception must not fly through the
     * library: it waits until the call is over. */
    template <class Call> static realistic_status listened(const Options &options, Call call) {
        Listener listener{options.log_, nullptr};
        realistic_options raw = options.raw_;
        if (options.log_) {
            raw.log = listen;
            raw.log_user = &listener;
        }
        realistic_status status = call(&raw);
        if (listener.thrown) std::rethrow_exception(listener.thrown);
        return status;
    }

    struct Listener {
        const Log &log;
        std::exception_ptr thrown;
    };

    static void listen(void *user, int32_t level, const char *message) {
        Listener &listener = *static_cast<Listener *>(user);
        if (listener.thrown) return;
        try {
            listener.log(level, message);
        } catch (...) {
            listener.thrown = std::current_exception();
        }
    }

    /* What autofocus asks; once something was thrown it hears of nothing in sight. */
    struct Zones {
        const std::function<double(const realistic_ray &)> &distance;
        const std::function<double(const realistic_camera *, const realistic_zone &)> &contrast;
        std::exception_ptr thrown;

        template <class Ask> double asked(double nothing, Ask ask) {
            if (thrown) return nothing;
            try {
                return ask();
            } catch (...) {
                thrown = std::current_exception();
                return nothing;
            }
        }

        static double ask_distance(void *user, const realistic_ray *ray) {
            Zones &zones = *static_cast<Zones *>(user);
            return zones.asked(HUGE_VAL, [&] { return zones.distance(*ray); });
        }

        static double ask_contrast(void *user, const realistic_camera *camera, const realistic_zone *zone) {
            Zones &zones = *static_cast<Zones *>(user);
            return zones.asked(0, [&] { return zones.contrast(camera, *zone); });
        }
    };

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
        realistic_status status = Options::listened(options, [this](const realistic_options *raw) {
            realistic_camera *camera = nullptr;
            realistic_status status = api_.camera_new(raw, &camera);
            camera_.reset(camera);
            return status;
        });
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

    /* What `n` rays that enter the camera count; every `struct_size` is set here. */
    void importance(realistic_importance_rays rays, std::size_t n, realistic_importance importance) const {
        rays.struct_size = sizeof rays;
        importance.struct_size = sizeof importance;
        api_.check(api_.camera_importance(camera_.get(), n, &rays, &importance));
    }

    /* Directions toward the lens from `n` points of the scene, and what they count; every `struct_size` is set here. */
    void sample_importance(realistic_scene_points points, std::size_t n, realistic_aimed aimed,
                           realistic_importance importance) const {
        points.struct_size = sizeof points;
        aimed.struct_size = sizeof aimed;
        importance.struct_size = sizeof importance;
        api_.check(api_.camera_sample_importance(camera_.get(), n, &points, &aimed, &importance));
    }

    realistic_camera_info info() const {
        realistic_camera_info info;
        info.struct_size = sizeof info;
        api_.check(api_.camera_get_info(camera_.get(), &info));
        return info;
    }

    std::string lens_name() const { return Options::text(api_, api_.camera_get_lens_name, camera_.get()); }

    /* What the camera keeps and leaves out, and which model of the lens a tolerance chose: lines for people. */
    std::string plan() const { return Options::text(api_, api_.camera_plan, camera_.get()); }

    /* The handle for realistic.h's functions, still owned here; NULL once moved from. */
    const realistic_camera *get() const noexcept { return camera_.get(); }

    /* Gives the handle away: realistic_camera_free is the caller's from now on. */
    realistic_camera *release() noexcept { return camera_.release(); }

private:
    Api api_;
    std::unique_ptr<realistic_camera, decltype(&realistic_camera_free)> camera_;
};

/* A lens without a film, in lens space: origin at the first vertex, +z toward the scene, mm. Can be moved, not copied;
 * any number of threads may use it. */
class Lens {
public:
    /* Throws Error with the reason, and what to change. */
    explicit Lens(const Options &options) : api_(options.api_), lens_(nullptr, options.api_.lens_free) {
        realistic_status status = Options::listened(options, [this](const realistic_options *raw) {
            realistic_lens *lens = nullptr;
            realistic_status status = api_.lens_new(raw, &lens);
            lens_.reset(lens);
            return status;
        });
        api_.check(status);
    }

    realistic_lens_info info() const {
        realistic_lens_info info;
        info.struct_size = sizeof info;
        api_.check(api_.lens_get_info(lens_.get(), &info));
        return info;
    }

    /* Surface `number`, counted from 0 at the scene side. */
    realistic_lens_surface surface(uint32_t number) const {
        realistic_lens_surface surface;
        surface.struct_size = sizeof surface;
        api_.check(api_.lens_get_surface(lens_.get(), number, &surface));
        return surface;
    }

    std::string name() const { return Options::text(api_, api_.lens_get_name, lens_.get()); }

    /* Film distance, mm from the last vertex, that is sharp for an object so many mm from the film. */
    double focus(double object_distance_mm) const { return conjugate(api_.lens_focus, object_distance_mm); }

    /* What film so many mm behind the last vertex shows sharp, mm from the film; NaN where nothing is. */
    double focused_on(double film_distance_mm) const { return conjugate(api_.lens_focused_on, film_distance_mm); }

    /* Takes `n` rays through the lens, in place; sets `struct_size` of `rays`. */
    void trace(realistic_side from, std::size_t n, realistic_lens_rays rays) const {
        rays.struct_size = sizeof rays;
        api_.check(api_.lens_trace(lens_.get(), from, n, &rays));
    }

    /* The handle for realistic.h's functions, still owned here; NULL once moved from. */
    const realistic_lens *get() const noexcept { return lens_.get(); }

private:
    template <class Function> double conjugate(Function function, double distance) const {
        double found = 0;
        api_.check(function(lens_.get(), distance, &found));
        return found;
    }

    Api api_;
    std::unique_ptr<realistic_lens, decltype(&realistic_lens_free)> lens_;
};

} // namespace realistic

#endif /* REALISTIC_HPP */
