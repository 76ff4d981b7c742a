// A C++11 host of realistic.hpp, which is linked with the library (REALISTIC_LINKED) or loads it, and prints its
// results for tests/abi/hosts/cpp_host.rs to check.

#include "realistic.hpp"
#include "realistic.hpp" // included twice, to test the include guard

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <thread>
#include <type_traits>

#ifndef REALISTIC_LINKED
#include <dlfcn.h>
#endif

// The host's own types, whose names the headers must not use.
struct Camera { int own; };
struct Sample { int own; };
struct Ray { int own; };

using Owner = realistic::Camera;
static_assert(!std::is_copy_constructible<Owner>::value && !std::is_copy_assignable<Owner>::value, "one owner");
static_assert(std::is_nothrow_move_constructible<Owner>::value, "can move");

static realistic::Api api(const char *path) {
#ifdef REALISTIC_LINKED
    (void)path;
    return realistic::Api::linked();
#else
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) throw std::runtime_error(dlerror());
    try {
        realistic::Api::find([](const char *) -> void * { return nullptr; });
    } catch (const realistic::Error &error) {
        std::printf("missing %d %s\n", static_cast<int>(error.status()), error.what());
    }
    return realistic::Api::find([library](const char *name) { return dlsym(library, name); });
#endif
}

static realistic_sample sample_at(unsigned i) {
    auto part = [i](double step) { return static_cast<float>(std::fmod((i + 0.5) * step, 1.0)); };
    return {40 * part(0.8567), 30 * part(0.7339), part(0.6287), part(0.5386), 0.5f};
}

static void refusals(const realistic::Api &api) {
    auto refuse = [](const char *what, const realistic::Options &options) {
        try {
            Owner camera(options);
            std::printf("built %s\n", what);
        } catch (const realistic::Error &error) {
            std::printf("%s %d %s\n", what, static_cast<int>(error.status()), error.what());
        }
    };
    refuse("lens", realistic::Options(40, 30, api).set(&realistic_options::lens_file, "nolens"));
    refuse("range", realistic::Options(40, 30, api).set(&realistic_options::film_diagonal, -1));
    refuse("near", realistic::Options(40, 30, api).set(&realistic_options::focus_distance, 10));
    refuse("text", realistic::Options(40, 30, api).lens_text("20 5\n"));
    refuse("both", realistic::Options(40, 30, api).simple_weighting(true).set(&realistic_options::weighting, "none"));
    refuse("pixels", realistic::Options(0, 30, api));
}

static void cameras(const realistic::Api &api) {
    const float moved[16] = {1, 0, 0, 5, 0, 1, 0, 6, 0, 0, 1, 7, 0, 0, 0, 1};
    int logged = 0;
    realistic::Options options(40, 30, api);
    // Strings and numbers of this scope are gone before the camera is built.
    {
        std::string name = "wide.22mm";
        name += "@35mm";
        options.set(&realistic_options::pupil, "rear").set(&realistic_options::lens_file, name);
        options.set(&realistic_options::fnumber, 0.5).camera_to_world(moved);
        options.log([&logged](int32_t level, const char *message) {
            ++logged;
            std::printf("log %d %s\n", static_cast<int>(level), message);
        });
    }
    realistic::Options elsewhere = std::move(options);
    Owner first(elsewhere);
    const realistic_camera *handle = first.get();
    Owner camera = std::move(first);
    std::printf("moved %d %d\n", first.get() == nullptr, camera.get() == handle);
    std::printf("logged %d\n", logged);
    realistic_camera_info info = camera.info();
    std::printf("info %s %.17g %u\n", camera.lens_name().c_str(), info.focal_length_mm,
                static_cast<unsigned>(info.interfaces));
    const double window[4] = {-3, 3, -2, 2};
    realistic::Options flat(40, 30, api);
    flat.set(&realistic_options::model, "orthographic").set(&realistic_options::screen_window, window).crop(8, 0, 16, 30);
    Owner cropped(flat);
    realistic_camera_info part = cropped.info();
    std::printf("crop %u %u %u %u of %u %u\n", part.crop[0], part.crop[1], part.crop[2], part.crop[3], info.crop[2],
                info.crop[3]);
    realistic_ray corner;
    cropped.generate({0, 0, 0.5f, 0.5f, 0}, corner);
    std::printf("corner %g %g\n", corner.o[0], corner.o[1]);
    std::printf("plan %d\n", camera.plan().find("exact trace") != std::string::npos);

    const unsigned n = 2000;
    std::vector<realistic_sample> samples(n);
    std::vector<realistic_ray> one(n), many(n);
    std::vector<float> weight(n), weights(n), threaded(n);
    std::vector<realistic_reason> reasons(n);
    for (unsigned i = 0; i < n; ++i) {
        samples[i] = sample_at(i);
        weight[i] = camera.generate(samples[i], one[i]);
    }
    camera.generate(samples.data(), n, many.data(), weights.data(), reasons.data());
    std::vector<float> in[5], out[7];
    for (auto &array : in) array.resize(n);
    for (auto &array : out) array.resize(n);
    for (unsigned i = 0; i < n; ++i) {
        in[0][i] = samples[i].image_x, in[1][i] = samples[i].image_y;
        in[2][i] = samples[i].lens_u, in[3][i] = samples[i].lens_v, in[4][i] = samples[i].time;
    }
    realistic_samples_soa from = {in[0].data(), in[1].data(), in[2].data(), in[3].data(), in[4].data()};
    realistic_rays_soa to = {out[0].data(), out[1].data(), out[2].data(), out[3].data(), out[4].data(), out[5].data(),
                             nullptr, nullptr, nullptr, out[6].data(), nullptr};
    camera.generate(from, n, to);
    std::thread([&] {
        realistic_ray ray;
        for (unsigned i = 0; i < n; ++i) threaded[i] = camera.generate(samples[i], ray);
    }).join();
    int different = 0, passed = 0;
    for (unsigned i = 0; i < n; ++i) {
        bool passes = weight[i] > 0;
        passed += passes;
        different += std::memcmp(&one[i], &many[i], sizeof one[i]) != 0 || weight[i] != weights[i] ||
                     weight[i] != out[6][i] || weight[i] != threaded[i] || one[i].o[0] != out[0][i] ||
                     one[i].d[2] != out[5][i] || passes != (reasons[i] == REALISTIC_REASON_OK);
    }
    std::printf("rays %d %d\n", different, passed);

    std::vector<float> out_wide[3][7];
    for (auto &arrays : out_wide) {
        for (auto &array : arrays) array.resize(n);
    }
    auto rays_of = [&out_wide](int k) {
        auto &a = out_wide[k];
        return realistic_rays_soa{a[0].data(), a[1].data(), a[2].data(), a[3].data(), a[4].data(), a[5].data(),
                                  nullptr,     nullptr,     nullptr,     a[6].data(), nullptr};
    };
    realistic_rays_soa own = rays_of(0), rx = rays_of(1), ry = rays_of(2);
    realistic_request request;
    realistic_request_of_arrays(&request, &from, &own);
    request.rx_origin = {rx.ox, rx.oy, rx.oz, sizeof(float)}, request.rx_direction = {rx.dx, rx.dy, rx.dz, sizeof(float)};
    request.ry_origin = {ry.ox, ry.oy, ry.oz, sizeof(float)}, request.ry_direction = {ry.dx, ry.dy, ry.dz, sizeof(float)};
    request.rx_weight = {rx.weight, nullptr, nullptr, sizeof(float)};
    request.ry_weight = {ry.weight, nullptr, nullptr, sizeof(float)};
    request.struct_size = 0; // set by `generate`
    camera.generate(request, n);
    int unlike = 0, both = 0;
    for (unsigned i = 0; i < n; ++i) {
        realistic_ray_differential ray = {};
        unlike += camera.generate(samples[i], ray) != weight[i] || out_wide[0][6][i] != weight[i];
        if (!(weight[i] > 0)) continue;
        uint32_t has = (rx.weight[i] > 0 ? REALISTIC_HAS_RX : 0) | (ry.weight[i] > 0 ? REALISTIC_HAS_RY : 0);
        unlike += ray.has != has || std::memcmp(&ray.ray, &one[i], sizeof one[i]) != 0 ||
                  out_wide[1][0][i] != ray.rx_o[0] || out_wide[2][5][i] != ray.ry_d[2];
        both += ray.has == (REALISTIC_HAS_RX | REALISTIC_HAS_RY);
    }
    std::printf("differentials %d %d\n", unlike, both);
    try {
        camera.generate(nullptr, 1, many.data(), weights.data());
    } catch (const realistic::Error &error) {
        std::printf("null %d %s\n", static_cast<int>(error.status()), error.what());
    }
    api.camera_free(camera.release());
    std::printf("released %d\n", camera.get() == nullptr);

    elsewhere.log([](int32_t, const char *) { throw std::logic_error("thrown by the log"); });
    try {
        Owner none(elsewhere);
    } catch (const std::logic_error &error) {
        std::printf("through %s\n", error.what());
    }
}

static void wavelengths(const realistic::Api &api) {
    realistic::Options options(40, 30, api);
    Owner camera(options.set(&realistic_options::lens_file, "dgauss.100mm"));
    const unsigned n = 200;
    std::vector<realistic_sample> samples(n);
    std::vector<realistic_ray> many(n);
    std::vector<float> nm(n), fours(4 * n), weights(n);
    std::vector<realistic_reason> reasons(n);
    std::vector<float> in[5], out[2][7];
    for (auto &array : in) array.resize(n);
    for (auto &array : out[0]) array.resize(n);
    for (auto &array : out[1]) array.resize(4 * n);
    for (unsigned i = 0; i < n; ++i) {
        samples[i] = sample_at(i);
        nm[i] = 370.0f + 2.1f * static_cast<float>(i);
        for (unsigned k = 0; k < 4; ++k) fours[4 * i + k] = 390.0f + 95.0f * static_cast<float>(k);
        in[0][i] = samples[i].image_x, in[1][i] = samples[i].image_y;
        in[2][i] = samples[i].lens_u, in[3][i] = samples[i].lens_v, in[4][i] = samples[i].time;
    }
    realistic_samples_soa from = {in[0].data(), in[1].data(), in[2].data(), in[3].data(), in[4].data()};
    auto rays_of = [&out](int k) {
        auto &a = out[k];
        return realistic_rays_soa{a[0].data(), a[1].data(), a[2].data(), a[3].data(), a[4].data(), a[5].data(),
                                  nullptr,     nullptr,     nullptr,     a[6].data(), nullptr};
    };
    realistic_request request;
    realistic_request_of_structures(&request, samples.data(), 0, many.data(), 0, weights.data(), reasons.data());
    request.wavelength = {nm.data(), nullptr, nullptr, sizeof(float)};
    camera.generate(request, n);
    realistic_rays_soa to[2] = {rays_of(0), rays_of(1)};
    realistic_request_of_arrays(&request, &from, &to[0]);
    request.wavelength = {nm.data(), nullptr, nullptr, sizeof(float)};
    camera.generate(request, n);
    realistic_request_of_arrays(&request, &from, &to[1]);
    request.wavelength = {fours.data(), nullptr, nullptr, sizeof(float)}, request.wavelengths_per_sample = 4;
    camera.generate(request, n);
    int different = 0, passed = 0, none = 0;
    for (unsigned i = 0; i < n; ++i) {
        realistic_ray ray = many[i], four[4];
        float weight = camera.generate_at(samples[i], nm[i], ray), four_weights[4];
        const float of_sample[4] = {fours[4 * i], fours[4 * i + 1], fours[4 * i + 2], fours[4 * i + 3]};
        realistic_request hero{};
        hero.wavelengths_per_sample = 4, hero.wavelength = {of_sample, nullptr, nullptr, sizeof(float)};
        hero.weight = {four_weights, nullptr, nullptr, sizeof(float)};
        different += camera.generate(samples[i], hero, four) != four_weights[0];
        passed += weight > 0;
        none += reasons[i] == REALISTIC_REASON_WAVELENGTH;
        different += weight != weights[i] || weight != out[0][6][i] || (weight > 0 && ray.d[1] != out[0][4][i]) ||
                     std::memcmp(&ray, &many[i], sizeof ray) != 0;
        for (unsigned k = 0; k < 4; ++k) {
            realistic_ray one;
            float alone = camera.generate_at(samples[i], of_sample[k], one);
            different += alone != four_weights[k] || alone != out[1][6][4 * i + k] ||
                         (alone > 0 && (one.d[0] != four[k].d[0] || one.o[1] != out[1][1][4 * i + k]));
        }
    }
    std::printf("wavelengths %d %d %d\n", different, passed, none);
    std::printf("capable %d\n", api.serves_pbrt());
}

static void lenses(const realistic::Api &api) {
    realistic::Options options(api);
    options.set(&realistic_options::lens_file, "wide.22mm").set(&realistic_options::fnumber, 8);
    realistic::Lens opened(options);
    realistic::Lens lens = std::move(opened);
    realistic_lens_info info = lens.info();
    std::printf("lens %s %.17g %.17g %u\n", lens.name().c_str(), info.focal_length_mm, info.fnumber,
                static_cast<unsigned>(info.surfaces));
    std::printf("stop %d\n", lens.surface(static_cast<uint32_t>(info.stop)).is_stop == 1);
    std::printf("focus %.17g\n", lens.focused_on(lens.focus(1000)));
    double at[6] = {0, 0, 50, 0, 0, -1};
    realistic_reason reason;
    auto vectors = [](double *first) { return realistic_vectors{first, first + 1, first + 2, 6 * sizeof(double)}; };
    double path = 0;
    lens.trace(REALISTIC_SIDE_SCENE, 1, {0, vectors(at), vectors(at + 3), &reason, sizeof reason, &path, sizeof path});
    if (!(path > 50)) throw std::logic_error("no optical path");
    double start[6] = {0, 0, 50, 0, 0, -1};
    std::vector<double> along[3];
    for (auto &axis : along) axis.resize(info.surfaces);
    uint32_t met = 0;
    lens.trace(REALISTIC_SIDE_SCENE, 1, {0, vectors(start), vectors(start + 3), nullptr, 0, nullptr, 0},
               {0, {along[0].data(), along[1].data(), along[2].data(), sizeof(double)}, &met, sizeof met});
    double off = 0;
    for (uint32_t i = 0; i < info.surfaces; ++i) off += std::fabs(along[2][i] - lens.surface(i).vertex_mm);
    std::printf("points %u %d %g\n", static_cast<unsigned>(met), off < 1e-12, start[2] - at[2]);
    std::printf("axis %d %.17g %.17g\n", static_cast<int>(reason), at[2] - info.rear_vertex_mm, at[5]);
    try {
        lens.surface(99);
    } catch (const realistic::Error &error) {
        std::printf("none %d %s\n", static_cast<int>(error.status()), error.what());
    }

    realistic::Options camera(40, 30, api);
    std::vector<realistic_zone> zones = {{10, 10, 30, 20}};
    double film = camera.autofocus(zones, REALISTIC_AUTOFOCUS_RULE_CENTRE, [](const realistic_ray &ray) {
        return (800 - ray.o[2]) / ray.d[2];
    });
    camera.set(&realistic_options::film_distance, film);
    std::printf("autofocus %.17g\n", Owner(camera).info().focus_distance_mm);
    try {
        camera.autofocus(zones, REALISTIC_AUTOFOCUS_RULE_CENTRE,
                         [](const realistic_ray &) -> double { throw std::logic_error("thrown by the callback"); });
    } catch (const realistic::Error &) {
        std::printf("refused for its film distance\n");
    }
    realistic::Options again(40, 30, api);
    try {
        again.autofocus(zones, REALISTIC_AUTOFOCUS_RULE_CENTRE,
                        [](const realistic_ray &) -> double { throw std::logic_error("thrown by the callback"); });
    } catch (const std::logic_error &error) {
        std::printf("through %s\n", error.what());
    }
}

static void importance(const realistic::Api &api) {
    Owner camera(realistic::Options(40, 30, api));
    const float x[2] = {0, 1e4f}, y[2] = {0, 0}, z[2] = {2000, 10}, u[2] = {0.3f, 0.3f}, v[2] = {0.4f, 0.4f};
    realistic_scene_points points{};
    const ptrdiff_t number = sizeof(float);
    points.point = {x, y, z, number}, points.lens = {u, v, nullptr, number};
    float ox[2], oy[2], oz[2], dx[2], dy[2], dz[2], density[2], first[2], again[2], image_x[2], image_y[2];
    realistic_aimed aimed{};
    aimed.origin = {ox, oy, oz, number}, aimed.direction = {dx, dy, dz, number};
    aimed.density = {density, nullptr, nullptr, number};
    realistic_importance found{};
    found.importance = {first, nullptr, nullptr, number}, found.image = {image_x, image_y, nullptr, number};
    camera.sample_importance(points, 2, aimed, found);
    realistic_importance_rays rays{};
    rays.origin = {ox, oy, oz, number}, rays.direction = {dx, dy, dz, number};
    realistic_importance counted{};
    counted.importance = {again, nullptr, nullptr, number};
    camera.importance(rays, 1, counted);
    std::printf("importance %g %g %g %g\n", first[0], again[0] / first[0], image_x[0], first[1]);
    try {
        Owner(realistic::Options(40, 30, api).set(&realistic_options::model, "environment"))
            .importance(rays, 1, counted);
    } catch (const realistic::Error &error) {
        std::printf("environment %d %s\n", static_cast<int>(error.status()), error.what());
    }
}

int main(int count, char **argument) {
    if (count != 3) return 1;
    realistic::Api functions = api(argument[1]);
    if (std::strcmp(argument[2], "refusals") == 0) refusals(functions);
    if (std::strcmp(argument[2], "cameras") == 0) cameras(functions);
    if (std::strcmp(argument[2], "lenses") == 0) lenses(functions);
    if (std::strcmp(argument[2], "wavelengths") == 0) wavelengths(functions);
    if (std::strcmp(argument[2], "importance") == 0) importance(functions);
#ifdef REALISTIC_LINKED
    // A linked program need not give the library's file.
    std::printf("linked %s\n", Owner(realistic::Options(4, 3)).lens_name().c_str());
#endif
    return 0;
}
