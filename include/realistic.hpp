/* realistic.hpp: realistic.h with owners and exceptions, for C++11 and later. MIT OR Apache-2.0.
 *
 *     realistic::Options options(640, 480);
 *     options.set(&realistic_options::lens_file, "wide.22mm").set(&realistic_options::fnumber, 8);
 *     realistic::Camera camera(options);
 *     float weight = camera.generate(sample, ray);
 *
 * Header only. A program either links against the library, or loads it and passes the functions to
 * Options: realistic::Api::find([&](const char *name) { return dlsym(library, name); }). The library
 * must then stay loaded as long as a camera lives. */

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

/* A failed call, with the library's message and the status. */
class Error : public std::runtime_error {
public:
    Error(realistic_status status, const std::string &message) : std::runtime_error(message), status_(status) {}

    realistic_status status() const noexcept { return status_; }

private:
    realistic_status status_;
};

/* The library's functions that this header calls, without the prefix realistic_; each becomes a member of
 * Api. */
#define REALISTIC_FUNCTIONS(X)      \
    X(version)                      \
    X(capabilities)                 \
    X(last_error)                   \
    X(status_name)                  \
    X(options_init)                 \
    X(camera_new)                   \
    X(camera_free)                  \
    X(camera_get_info)              \
    X(camera_get_lens_name)         \
    X(camera_plan)                  \
    X(generate_ray)                 \
    X(generate_ray_differential)    \
    X(camera_generate_batch)        \
    X(camera_importance)            \
    X(camera_sample_importance)     \
    X(autofocus)                    \
    X(lens_new)                     \
    X(lens_free)                    \
    X(lens_get_info)                \
    X(lens_get_surface)             \
    X(lens_get_name)                \
    X(lens_focus)                   \
    X(lens_focused_on)              \
    X(lens_plane_of_focus)          \
    X(lens_trace)                   \
    X(catalogue)

/* The library's functions, either linked or looked up in a loaded library. */
struct Api {
#define REALISTIC_MEMBER(name) decltype(&realistic_##name) name;
    REALISTIC_FUNCTIONS(REALISTIC_MEMBER)
#undef REALISTIC_MEMBER

    /* Returns the functions with which the program is linked. A program that only loads the library never
     * calls this. */
    static Api linked() {
        require_version(realistic_abi_version());
        Api api;
#define REALISTIC_TAKE(name) api.name = realistic_##name;
        REALISTIC_FUNCTIONS(REALISTIC_TAKE)
#undef REALISTIC_TAKE
        return api;
    }

    /* Returns the functions of a loaded library. `symbol` is called with the name of each function and
     * returns its address as a void pointer. Throws Error if a function is missing or the library is older
     * than this header. */
    template <class Symbol> static Api find(Symbol symbol) {
        decltype(&realistic_abi_version) version;
        resolve(symbol, "realistic_abi_version", version);
        require_version(version());
        Api api;
#define REALISTIC_RESOLVE(name) resolve(symbol, "realistic_" #name, api.name);
        REALISTIC_FUNCTIONS(REALISTIC_RESOLVE)
#undef REALISTIC_RESOLVE
        return api;
    }

    /* Throws Error with the message of a failed call or, if there is no message, the meaning of its status. */
    void check(realistic_status status) const {
        if (status == REALISTIC_STATUS_OK) return;
        const char *message = last_error();
        throw Error(status, *message != '\0' ? message : status_name(status));
    }

    /* Whether a pbrt-v1 host can load the library. */
    bool serves_pbrt() const { return (capabilities() & REALISTIC_CAPABILITY_PBRT_V1) != 0; }

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

/* Options of a camera or a lens; owns its strings. A member that is not set keeps its default. */
class Options {
public:
    /* Receives the level (0 information, 1 warning, 2 error) and the text of a message while a camera or a
     * lens is being built. The constructor rethrows exceptions of this function. */
    using Log = std::function<void(int32_t, const char *)>;

    Options(int32_t xres, int32_t yres) : Options(xres, yres, Api::linked()) {}

    /* Creates the options of a lens, which has no film. */
    Options() : Options(0, 0) {}
    explicit Options(const Api &api) : Options(0, 0, api) {}

    Options(int32_t xres, int32_t yres, const Api &api) : api_(api) {
        api_.check(api_.options_init(&raw_, sizeof raw_));
        raw_.xres = xres;
        raw_.yres = yres;
    }

    /* Sets a number, given its member: set(&realistic_options::fnumber, 8). */
    Options &set(double realistic_options::*member, double value) {
        raw_.*member = value;
        return *this;
    }

    /* Sets a string, given its member: set(&realistic_options::lens_file, "wide.22mm"). */
    Options &set(const char *realistic_options::*member, const std::string &value) {
        raw_.*member = keep(value);
        return *this;
    }

    /* Sets the text of a lens, which replaces the file of `lens_file`. */
    Options &lens_text(const std::string &text) {
        raw_.lens_text = keep(text);
        raw_.lens_text_size = text.size();
        return *this;
    }

    Options &simple_weighting(bool value) {
        raw_.simple_weighting = value ? 1 : 0;
        return *this;
    }

    /* Sets the numbers of an array, given its member: set(&realistic_options::screen_window, window). */
    template <class Number, std::size_t N>
    Options &set(Number (realistic_options::*member)[N], const Number (&values)[N]) {
        std::memcpy(raw_.*member, values, sizeof values);
        return *this;
    }

    /* Sets the part of the picture to render: columns from `x0` up to but excluding `x1`, rows from `y0` up
     * to but excluding `y1`. */
    Options &crop(uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1) {
        const double pixels[4] = {double(x0), double(y0), double(x1), double(y1)};
        return set(&realistic_options::crop, pixels);
    }

    /* Sets the matrix from camera space to world space, row-major, for column vectors. */
    Options &camera_to_world(const float (&rows)[16]) {
        return set(&realistic_options::camera_to_world, rows);
    }

    Options &log(Log log) {
        log_ = std::move(log);
        return *this;
    }

    const realistic_options &raw() const noexcept { return raw_; }

    /* Returns the film distance, mm, that focuses on zones of the picture; see realistic_autofocus. Pass
     * exactly one callback: `distance` receives a ray and returns the distance along it to the first surface;
     * `contrast` receives a zone and a camera, which it must not keep, and returns the contrast. This
     * function rethrows exceptions of the callback. */
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
        /* Each string has its own allocation, so that its address stays the same when the options are moved. */
        strings_.emplace_back(new std::string(value));
        return strings_.back()->c_str();
    }

    /* Returns a text that a function of the library copies into a buffer. */
    template <class Function, class Handle>
    static std::string text(const Api &api, Function function, const Handle *handle) {
        std::size_t length = 0;
        api.check(function(handle, nullptr, 0, &length));
        std::vector<char> buffer(length + 1);
        api.check(function(handle, buffer.data(), buffer.size(), nullptr));
        return std::string(buffer.data(), length);
    }

    /* Calls `call` with the options and their log, and rethrows the log's exception. The exception is kept
     * until the call is over, because it must not pass through the library. */
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

    /* Builds a camera or a lens with the given function of the library. Throws Error with the reason and what
     * to change. */
    template <class Handle, class Create, class Free>
    std::unique_ptr<Handle, Free> made(Create create, Free free) const {
        std::unique_ptr<Handle, Free> owner(nullptr, free);
        api_.check(listened(*this, [&](const realistic_options *raw) {
            Handle *handle = nullptr;
            realistic_status status = create(raw, &handle);
            owner.reset(handle);
            return status;
        }));
        return owner;
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

    /* Callbacks for autofocus. After an exception they return "no surface" or "contrast unknown" without
     * calling the function. */
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

/* A camera, which is freed with this object. It can be moved but not copied; any number of threads may
 * request rays. */
class Camera {
public:
    /* Builds a camera. Throws Error with the reason and what to change. */
    explicit Camera(const Options &options)
        : api_(options.api_), camera_(options.made<realistic_camera>(api_.camera_new, api_.camera_free)) {}

    /* Builds the same camera as the other constructor, bit for bit, in less time, if `options` differ from
     * those of `donor` only in focus, stop, zoom or pose. `donor` may be destroyed afterwards. Throws Error
     * with the reason and what to change. */
    Camera(const Camera &donor, const Options &options)
        : api_(options.api_),
          camera_(options.made<realistic_camera>(
              [&](const realistic_options *raw, realistic_camera **out) {
                  realistic_options with_donor = *raw;
                  with_donor.donor = donor.get();
                  return api_.camera_new(&with_donor, out);
              },
              api_.camera_free)) {}

    /* Returns the weight of a ray; 0, with the ray unchanged, if the lens blocks it. */
    float generate(const realistic_sample &sample, realistic_ray &ray) const noexcept {
        return api_.generate_ray(camera_.get(), &sample, nullptr, &ray);
    }

    /* Generates the rays that `request` requests, one per wavelength of the sample, and returns the weight of
     * the first. Sets `struct_size` of `request`. */
    float generate(const realistic_sample &sample, realistic_request request, realistic_ray *rays) const noexcept {
        request.struct_size = sizeof request;
        return api_.generate_ray(camera_.get(), &sample, &request, rays);
    }

    /* Returns the weight of a ray at a wavelength, nm; 0, with the ray unchanged, if there is no ray. */
    float generate_at(const realistic_sample &sample, float wavelength, realistic_ray &ray) const noexcept {
        return generate(sample, at(wavelength), &ray);
    }

    /* Returns the weight of a ray with differentials; 0 if the lens blocks the ray. Sets `struct_size` of
     * `ray`; if the weight is 0, the other members are not changed. */
    float generate(const realistic_sample &sample, realistic_ray_differential &ray) const noexcept {
        ray.struct_size = sizeof ray;
        return api_.generate_ray_differential(camera_.get(), &sample, nullptr, &ray);
    }

    /* Returns the weight of a ray with differentials at a wavelength given in nm. */
    float generate_at(const realistic_sample &sample, float wavelength,
                      realistic_ray_differential &ray) const noexcept {
        realistic_request request = at(wavelength);
        request.struct_size = sizeof request;
        ray.struct_size = sizeof ray;
        return api_.generate_ray_differential(camera_.get(), &sample, &request, &ray);
    }

    /* Generates the rays that `request` requests for `n` samples; sets `struct_size` of `request`. */
    void generate(realistic_request request, std::size_t n) const {
        request.struct_size = sizeof request;
        api_.check(api_.camera_generate_batch(camera_.get(), n, &request));
    }

    /* Generates the rays of `n` samples; `reasons` may be NULL. Strides are in bytes; 0 means tightly
     * packed. */
    void generate(const realistic_sample *samples, std::size_t n, realistic_ray *rays, float *weights,
                  realistic_reason *reasons = nullptr, std::size_t sample_stride = 0,
                  std::size_t ray_stride = 0) const {
        realistic_request request;
        realistic_request_of_structures(&request, samples, sample_stride, rays, ray_stride, weights, reasons);
        generate(request, n);
    }

    /* Generates the rays of `n` samples; samples and rays are structures of arrays. */
    void generate(const realistic_samples_soa &samples, std::size_t n, const realistic_rays_soa &rays) const {
        realistic_request request;
        realistic_request_of_arrays(&request, &samples, &rays);
        generate(request, n);
    }

    /* Computes the importance of `n` rays that enter the camera; sets `struct_size` of both structures. */
    void importance(realistic_importance_rays rays, std::size_t n, realistic_importance importance) const {
        rays.struct_size = sizeof rays;
        importance.struct_size = sizeof importance;
        api_.check(api_.camera_importance(camera_.get(), n, &rays, &importance));
    }

    /* Samples directions toward the lens from `n` points of the scene, and computes their importance; sets
     * `struct_size` of all structures. */
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

    /* Returns a text for people: the effects that the camera keeps and leaves out, and the lens model that a
     * tolerance selected. */
    std::string plan() const { return Options::text(api_, api_.camera_plan, camera_.get()); }

    /* Returns the handle for the functions of realistic.h; this object still owns it. NULL after this object
     * was moved from. */
    const realistic_camera *get() const noexcept { return camera_.get(); }

    /* Releases the handle to the caller, who must pass it to realistic_camera_free. */
    realistic_camera *release() noexcept { return camera_.release(); }

private:
    /* Returns a request for rays at `wavelength`; this variable must outlive the request. */
    static realistic_request at(const float &wavelength) noexcept {
        realistic_request request{};
        request.wavelength.x = &wavelength;
        return request;
    }

    Api api_;
    std::unique_ptr<realistic_camera, decltype(&realistic_camera_free)> camera_;
};

/* A lens without a film, in lens space: the origin is the first vertex, +z points toward the scene, and
 * lengths are in mm. It can be moved but not copied; any number of threads may use it. */
class Lens {
public:
    /* Opens a lens. Throws Error with the reason and what to change. */
    explicit Lens(const Options &options)
        : api_(options.api_), lens_(options.made<realistic_lens>(api_.lens_new, api_.lens_free)) {}

    realistic_lens_info info() const {
        realistic_lens_info info;
        info.struct_size = sizeof info;
        api_.check(api_.lens_get_info(lens_.get(), &info));
        return info;
    }

    /* Returns surface `number`, counted from 0 at the scene side. */
    realistic_lens_surface surface(uint32_t number) const {
        realistic_lens_surface surface;
        surface.struct_size = sizeof surface;
        api_.check(api_.lens_get_surface(lens_.get(), number, &surface));
        return surface;
    }

    std::string name() const { return Options::text(api_, api_.lens_get_name, lens_.get()); }

    /* Returns the film distance, mm from the last vertex, that focuses on an object `focus_distance_mm` from
     * the film. */
    double focus(double focus_distance_mm) const { return conjugate(api_.lens_focus, focus_distance_mm); }

    /* Returns the distance in focus, mm from the film, for a film at `film_distance` behind the last vertex;
     * NaN if no object is in focus. */
    double focused_on(double film_distance) const { return conjugate(api_.lens_focused_on, film_distance); }

    /* Returns the film that has the plane through three points (x, y, z) of lens space, mm, in focus. */
    realistic_focused_film plane_of_focus(const double (&points)[9]) const {
        realistic_focused_film film;
        film.struct_size = sizeof film;
        api_.check(api_.lens_plane_of_focus(lens_.get(), points, &film));
        return film;
    }

    /* Traces `n` rays through the lens, in place; sets `struct_size` of `rays`. */
    void trace(realistic_side from, std::size_t n, realistic_lens_rays rays) const {
        rays.struct_size = sizeof rays;
        api_.check(api_.lens_trace(lens_.get(), from, n, &rays, nullptr));
    }

    /* Traces `n` rays and returns the points where they meet the surfaces; sets `struct_size` of `rays` and
     * `points`. */
    void trace(realistic_side from, std::size_t n, realistic_lens_rays rays, realistic_lens_points points) const {
        rays.struct_size = sizeof rays;
        points.struct_size = sizeof points;
        api_.check(api_.lens_trace(lens_.get(), from, n, &rays, &points));
    }

    /* Returns the handle for the functions of realistic.h; this object still owns it. NULL after this object
     * was moved from. */
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

#undef REALISTIC_FUNCTIONS

/* Returns the names of the built-in lenses, beginning with that of the default lens. */
inline std::vector<std::string> catalogue(const Api &api = Api::linked()) {
    std::size_t length = 0;
    api.check(api.catalogue(nullptr, 0, &length));
    std::vector<char> buffer(length + 1);
    api.check(api.catalogue(buffer.data(), buffer.size(), nullptr));
    std::vector<std::string> names(1);
    for (std::size_t i = 0; i < length; ++i) {
        if (buffer[i] == '\n') names.emplace_back();
        else names.back() += buffer[i];
    }
    return names;
}

} // namespace realistic

#endif /* REALISTIC_HPP */
