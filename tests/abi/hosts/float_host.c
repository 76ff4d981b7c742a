/* A host with unusual floating-point settings: trapped exceptions, watched flags, other rounding modes, flushed
 * subnormal numbers. Requests rays from cameras of every model, and checks that the library works in these settings and
 * leaves them unchanged. float_host.rs runs it: PLUGIN ACTION RAYS. */

#define _GNU_SOURCE
#include "realistic.h"

#include <dlfcn.h>
#include <fenv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xmmintrin.h>

#define TRAPS (FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW)
#define N 257

static struct {
    const char *(*last_error)(void);
    realistic_status (*options_init)(realistic_options *, uint32_t);
    realistic_status (*camera_new)(const realistic_options *, realistic_camera **);
    void (*camera_free)(realistic_camera *);
    float (*ray)(const realistic_camera *, const realistic_sample *, const realistic_request *, realistic_ray *);
    float (*differential)(const realistic_camera *, const realistic_sample *, const realistic_request *,
                          realistic_ray_differential *);
    realistic_status (*batch)(const realistic_camera *, size_t, const realistic_request *);
    realistic_status (*autofocus)(const realistic_options *, const realistic_zone *, size_t, int32_t,
                                  realistic_distance, realistic_contrast, void *, double *);
} api;

/* The exported batch, for the header's inline functions: the library is loaded, not linked. */
realistic_status realistic_camera_generate_batch(const realistic_camera *camera, size_t n,
                                                 const realistic_request *request) {
    return api.batch(camera, n, request);
}

static void resolve(void *library, const char *name, void *function) {
    void *symbol = dlsym(library, name);
    if (symbol == NULL) exit(2);
    memcpy(function, &symbol, sizeof symbol);
}

static void load(const char *path) {
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (library == NULL) exit(2);
    resolve(library, "realistic_last_error", &api.last_error);
    resolve(library, "realistic_options_init", &api.options_init);
    resolve(library, "realistic_camera_new", &api.camera_new);
    resolve(library, "realistic_camera_free", &api.camera_free);
    resolve(library, "realistic_generate_ray", &api.ray);
    resolve(library, "realistic_generate_ray_differential", &api.differential);
    resolve(library, "realistic_camera_generate_batch", &api.batch);
    resolve(library, "realistic_autofocus", &api.autofocus);
}

/* The columns are pupil, disk, refraction, precision and shutter, as in the options; NULL means the default. */
static const struct {
    const char *model, *lens_file, *pupil, *disk, *refraction, *precision, *shutter;
    double tolerance, fnumber, lens_radius;
    int moves;
} cameras[] = {
    {.model = "lens"},
    {.lens_file = "wide.22mm", .pupil = "rear"},
    {.lens_file = "telephoto.250mm", .pupil = "disk", .disk = "polar"},
    {.lens_file = "fisheye.10mm", .precision = "f32"},
    {.lens_file = "phone.4mm", .pupil = "rear"},
    {.pupil = "rear", .disk = "rejection", .precision = "f32", .fnumber = 22},
    {.pupil = "rear", .refraction = "heckbert"},
    {.pupil = "rear", .refraction = "whitted", .precision = "f32"},
    {.pupil = "rear", .refraction = "other", .shutter = "leaf"},
    {.tolerance = 1, .fnumber = 8},
    {.tolerance = 0.01, .fnumber = 8},
    {.moves = 1, .shutter = "focal-plane"},
    {.model = "thick", .disk = "polar"},
    {.model = "thin", .disk = "rejection", .moves = 1},
    {.model = "perspective"},
    {.model = "perspective", .lens_radius = 0.5, .disk = "rejection", .shutter = "leaf"},
    {.model = "orthographic", .lens_radius = 0.5, .moves = 1},
    {.model = "environment"},
};
#define CAMERAS (sizeof cameras / sizeof cameras[0])

static realistic_options options_of(size_t i) {
    realistic_options o;
    if (api.options_init(&o, sizeof o) != REALISTIC_STATUS_OK) exit(3);
    o.xres = 40, o.yres = 30;
    o.model = cameras[i].model, o.lens_file = cameras[i].lens_file, o.pupil = cameras[i].pupil;
    o.disk = cameras[i].disk, o.refraction = cameras[i].refraction, o.precision = cameras[i].precision;
    o.shutter = cameras[i].shutter;
    if (cameras[i].tolerance > 0) o.tolerance = cameras[i].tolerance;
    if (cameras[i].fnumber > 0) o.fnumber = cameras[i].fnumber;
    if (cameras[i].lens_radius > 0) o.lens_radius = cameras[i].lens_radius;
    if (cameras[i].moves) {
        memcpy(o.camera_to_world_end, o.camera_to_world, sizeof o.camera_to_world);
        o.camera_to_world_end[0] = 0.6f, o.camera_to_world_end[2] = 0.8f;
        o.camera_to_world_end[8] = -0.8f, o.camera_to_world_end[10] = 0.6f;
        o.camera_to_world_end[3] = 5, o.camera_to_world[1] = 0.25f;
        o.camera_to_world_end[1] = 0.25f;
    }
    return o;
}

static unsigned control_changed, flags_raised, passed, blocked;
static unsigned control;

/* Checks a call that must raise no floating-point flag at all. */
static void quiet(realistic_status status) {
    flags_raised += fetestexcept(FE_ALL_EXCEPT) != 0;
    if (status != REALISTIC_STATUS_OK) {
        printf("failed %d %s\n", (int)status, api.last_error());
        exit(3);
    }
}

static realistic_camera *build(size_t i) {
    realistic_options o = options_of(i);
    realistic_camera *camera = NULL;
    feclearexcept(FE_ALL_EXCEPT);
    quiet(api.camera_new(&o, &camera));
    return camera;
}

static uint64_t state;

static uint32_t random_bits(void) {
    state += 0x9E3779B97F4A7C15ULL;
    uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return (uint32_t)((z ^ (z >> 31)) >> 32);
}

/* A number within the picture or around it, or random bits; without arithmetic on values that may be NaN. */
static void number(float *to, float from, float size) {
    uint32_t any = random_bits();
    float within = from + size * ((float)(any >> 8) / 16777216.0f);
    if (random_bits() % 32 == 0) memcpy(to, &any, sizeof any);
    else *to = within;
}

static realistic_sample random_sample(void) {
    realistic_sample sample;
    int far = random_bits() % 8 == 0;
    number(&sample.image_x, far ? -400.0f : -2.0f, far ? 800.0f : 44.0f);
    number(&sample.image_y, far ? -300.0f : -2.0f, far ? 600.0f : 34.0f);
    number(&sample.lens_u, 0, 1);
    number(&sample.lens_v, 0, 1);
    number(&sample.time, 0, 1);
    return sample;
}

/* The vector unit's control word, with the traps, is unchanged, and none of the three flags is raised. */
static void check_flags(void) {
    control_changed += (_mm_getcsr() & ~0x3Fu) != control;
    flags_raised += fetestexcept(TRAPS) != 0;
    feclearexcept(TRAPS);
}

static void count(float weight) {
    uint32_t bits;
    memcpy(&bits, &weight, sizeof bits);
    if (bits == 0) ++blocked;
    else ++passed;
}

static double distance(void *user, const realistic_ray *ray) {
    (void)user, (void)ray;
    return 3000;
}

/* Generates one ray by every other call. */
static void other_calls(const realistic_camera *camera, const realistic_sample *sample) {
    static const float four[4] = {450, 520, 610, 700};
    realistic_ray rays[4];
    float weights[4], wavelength;
    realistic_ray_differential ray;
    ray.struct_size = sizeof ray;
    number(&wavelength, 370, 420);
    api.differential(camera, sample, NULL, &ray);
    check_flags();
    realistic_request request;
    memset(&request, 0, sizeof request);
    request.struct_size = sizeof request;
    request.wavelength.x = &wavelength;
    api.ray(camera, sample, &request, rays);
    check_flags();
    api.differential(camera, sample, &request, &ray);
    check_flags();
    request.wavelengths_per_sample = 4;
    request.wavelength.x = four, request.wavelength.stride = sizeof(float);
    request.weight.x = weights, request.weight.stride = sizeof(float);
    api.ray(camera, sample, &request, rays);
    check_flags();
}

/* Makes every kind of call, with `rays` single rays of each camera. */
static void every_call(unsigned long rays) {
    static realistic_sample samples[N];
    static realistic_ray many[N];
    static float weights[N], in[5][N], out[10][N];
    static realistic_reason reasons[N];
    for (size_t i = 0; i < CAMERAS; ++i) {
        realistic_camera *camera = build(i);
        check_flags();
        for (unsigned long k = 0; k < rays; ++k) {
            realistic_sample sample = random_sample();
            realistic_ray ray;
            count(api.ray(camera, &sample, NULL, &ray));
            check_flags();
            if (k % 4 == 0) other_calls(camera, &sample);
        }
        for (unsigned k = 0; k < N; ++k) {
            samples[k] = random_sample();
            in[0][k] = samples[k].image_x, in[1][k] = samples[k].image_y;
            in[2][k] = samples[k].lens_u, in[3][k] = samples[k].lens_v, in[4][k] = samples[k].time;
        }
        feclearexcept(FE_ALL_EXCEPT);
        quiet(realistic_camera_generate_rays(camera, N, samples, 0, many, 0, weights, reasons));
        check_flags();
        realistic_samples_soa soa_in = {in[0], in[1], in[2], in[3], in[4]};
        realistic_rays_soa soa_out = {out[0], out[1], out[2], out[3], out[4], out[5],
                                      out[6], out[7], out[8], out[9], reasons};
        quiet(realistic_camera_generate_rays_soa(camera, N, &soa_in, &soa_out));
        check_flags();
        api.camera_free(camera);
    }
    realistic_options o = options_of(0);
    realistic_zone zone = {15, 10, 25, 20};
    double film = 0;
    feclearexcept(FE_ALL_EXCEPT);
    quiet(api.autofocus(&o, &zone, 1, 0, distance, NULL, NULL, &film));
    check_flags();
    printf("film %a\npassed %u\nblocked %u\ncontrol %u\nflags %u\n", film, passed, blocked, control_changed, flags_raised);
}

/* Hashes all bits of rays, weights and reasons, by single calls and by batches, with the same samples every time. */
static void hash(const char *name) {
    static realistic_sample samples[N];
    static realistic_ray many[N];
    static float weights[N];
    static realistic_reason reasons[N];
    uint64_t sum = 1469598103934665603ULL;
    unsigned before = _mm_getcsr() & ~0x3Fu;
    for (size_t i = 0; i < CAMERAS; ++i) {
        realistic_camera *camera = build(i);
        for (unsigned k = 0; k < N; ++k) {
            struct { realistic_ray ray; float weight; } one;
            memset(&one, 0, sizeof one);
            one.weight = api.ray(camera, &samples[k], NULL, &one.ray);
            for (size_t b = 0; b < sizeof one; ++b) sum = (sum ^ ((unsigned char *)&one)[b]) * 1099511628211ULL;
        }
        memset(many, 0, sizeof many);
        feclearexcept(FE_ALL_EXCEPT);
        quiet(realistic_camera_generate_rays(camera, N, samples, 0, many, 0, weights, reasons));
        for (size_t b = 0; b < sizeof many; ++b) sum = (sum ^ ((unsigned char *)many)[b]) * 1099511628211ULL;
        for (size_t b = 0; b < sizeof reasons; ++b) sum = (sum ^ ((unsigned char *)reasons)[b]) * 1099511628211ULL;
        api.camera_free(camera);
        /* The cameras are built once, in the default environment. */
        if (strcmp(name, "first") == 0)
            for (unsigned k = 0; k < N; ++k) samples[k] = random_sample();
    }
    printf("%s %016llx %d\n", name, (unsigned long long)sum, (_mm_getcsr() & ~0x3Fu) == before && flags_raised == 0);
}

int main(int argc, char **argv) {
    if (argc != 4) return 1;
    load(argv[1]);
    unsigned long rays = strtoul(argv[3], NULL, 10);
    if (strcmp(argv[2], "traps") == 0) {
        feclearexcept(FE_ALL_EXCEPT);
        feenableexcept(TRAPS);
        control = _mm_getcsr() & ~0x3Fu;
        every_call(rays);
        printf("traps %d\n", fegetexcept() == TRAPS);
        return 0;
    }
    if (strcmp(argv[2], "flags") == 0) {
        feclearexcept(FE_ALL_EXCEPT);
        control = _mm_getcsr() & ~0x3Fu;
        every_call(rays);
        /* Raised flags stay raised. */
        realistic_camera *camera = build(0);
        feraiseexcept(TRAPS);
        realistic_sample sample = {20, 15, 0.5f, 0.5f, 0};
        realistic_ray ray;
        api.ray(camera, &sample, NULL, &ray);
        printf("kept %d\n", fetestexcept(TRAPS) == TRAPS);
        api.camera_free(camera);
        return 0;
    }
    if (strcmp(argv[2], "modes") == 0) {
        static const unsigned modes[] = {0x1F80, 0x3F80, 0x5F80, 0x7F80, 0x9FC0, 0xFFC0};
        static const char *names[] = {"nearest", "down", "up", "zero", "flushed", "flushed-zero"};
        hash("first");
        for (size_t i = 0; i < sizeof modes / sizeof modes[0]; ++i) {
            _mm_setcsr(modes[i]);
            hash(names[i]);
        }
        return 0;
    }
    return 1;
}
