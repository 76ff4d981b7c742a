/* A C99 host: loads the library with dlopen, uses every function of the header, and prints the results for
 * tests/abi/hosts/c_host.rs to check. It uses only what realistic.h documents. */

#define _POSIX_C_SOURCE 200809L
#define REALISTIC_PBRT_ENTRY
#include "realistic.h"
#include "realistic.h" /* included twice, to test the include guard */

#include <dlfcn.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The host's own types, whose names the header must not use. */
typedef struct Camera { int own; } Camera;
typedef struct Sample { int own; } Sample;
typedef struct Ray { int own; } Ray;

static struct {
    uint32_t (*abi_version)(void);
    const char *(*version)(void);
    uint64_t (*capabilities)(void);
    const char *(*last_error)(void);
    const char *(*status_name)(int32_t);
    realistic_status (*options_init)(realistic_options *, uint32_t);
    realistic_status (*camera_new)(const realistic_options *, realistic_camera **);
    void (*camera_free)(realistic_camera *);
    realistic_status (*get_info)(const realistic_camera *, realistic_camera_info *);
    realistic_status (*get_lens_name)(const realistic_camera *, char *, size_t, size_t *);
    realistic_status (*plan)(const realistic_camera *, char *, size_t, size_t *);
    float (*ray)(const realistic_camera *, const realistic_sample *, const realistic_request *, realistic_ray *);
    float (*plain_ray)(const realistic_camera *, const realistic_sample *, realistic_ray *);
    float (*differential)(const realistic_camera *, const realistic_sample *, const realistic_request *,
                          realistic_ray_differential *);
    realistic_status (*batch)(const realistic_camera *, size_t, const realistic_request *);
    realistic_status (*lens_focus)(const realistic_lens *, double, double *);
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
    if (symbol == NULL) {
        printf("missing %s\n", name);
        exit(2);
    }
    /* ISO C has no cast from an object's to a function's pointer. */
    memcpy(function, &symbol, sizeof symbol);
}

static void load(const char *path) {
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (library == NULL) {
        printf("dlopen %s\n", dlerror());
        exit(2);
    }
    resolve(library, "realistic_abi_version", &api.abi_version);
    resolve(library, "realistic_version", &api.version);
    resolve(library, "realistic_capabilities", &api.capabilities);
    resolve(library, "realistic_last_error", &api.last_error);
    resolve(library, "realistic_status_name", &api.status_name);
    resolve(library, "realistic_options_init", &api.options_init);
    resolve(library, "realistic_camera_new", &api.camera_new);
    resolve(library, "realistic_camera_free", &api.camera_free);
    resolve(library, "realistic_camera_get_info", &api.get_info);
    resolve(library, "realistic_camera_get_lens_name", &api.get_lens_name);
    resolve(library, "realistic_camera_plan", &api.plan);
    resolve(library, "realistic_generate_ray", &api.ray);
    resolve(library, "GenerateRay", &api.plain_ray);
    resolve(library, "realistic_camera_generate_batch", &api.batch);
    resolve(library, "realistic_generate_ray_differential", &api.differential);
    resolve(library, "realistic_autofocus", &api.autofocus);
    resolve(library, "realistic_lens_focus", &api.lens_focus);
}

/* Prints "status name NUMBER MESSAGE", with the message on one line. */
static void report(const char *what, realistic_status status) {
    char text[1024];
    snprintf(text, sizeof text, "%s", status == REALISTIC_STATUS_OK ? "" : api.last_error());
    for (char *c = text; *c != '\0'; ++c) {
        if (*c == '\n') *c = ' ';
    }
    printf("%s %d %s\n", what, (int)status, text);
}

static realistic_options options(void) {
    realistic_options made;
    memset(&made, 0xA5, sizeof made);
    if (api.options_init(&made, sizeof made) != REALISTIC_STATUS_OK) exit(3);
    made.xres = 40;
    made.yres = 30;
    return made;
}

static realistic_camera *build(const realistic_options *given) {
    realistic_camera *camera = NULL;
    realistic_status status = api.camera_new(given, &camera);
    if (status != REALISTIC_STATUS_OK) {
        report("build", status);
        exit(3);
    }
    return camera;
}

/* A failing construction leaves the output as it was. */
static void refuse(const char *what, const realistic_options *given) {
    int mark;
    realistic_camera *before = (realistic_camera *)(void *)&mark, *camera = before;
    realistic_status status = api.camera_new(given, &camera);
    report(what, status);
    if (camera != before) printf("touched %s\n", what);
}

static void log_to_stdout(void *user, int32_t level, const char *message) {
    ++*(int *)user;
    printf("log %d %s\n", (int)level, message);
}

static void do_library(void) {
    printf("abi %u %u\n", (unsigned)api.abi_version(), (unsigned)REALISTIC_ABI_VERSION);
    printf("version %s\n", api.version());
    printf("capabilities %llu\n", (unsigned long long)api.capabilities());
    printf("empty [%s]\n", api.last_error());
    for (int status = -1; status < 13; ++status) printf("name %d %s\n", status, api.status_name(status));
}

static void do_refusals(void) {
    realistic_options o;
    report("init-null", api.options_init(NULL, sizeof o));
    report("init-small", api.options_init(&o, 4));
    /* The size is larger than any library knows, whatever the version of this header. */
    report("init-large", api.options_init(&o, 4096));
    refuse("options-null", NULL);
    o = options();
    report("out-null", api.camera_new(&o, NULL));
    o.struct_size = 8;
    refuse("size-small", &o);
    o.struct_size = 4096;
    refuse("size-large", &o);
    o.struct_size = 0;
    refuse("size-zero", &o);

    o = options(), o.xres = 0;
    refuse("no-pixels", &o);
    o = options(), o.yres = -3;
    refuse("negative-pixels", &o);
    o = options(), o.lens_file = "no/such/lens.dat";
    refuse("no-lens", &o);
    o = options(), o.stop_picture = "no/such/picture.png";
    refuse("no-picture", &o);
    o = options(), o.lens_file = "\xff\xfe";
    refuse("not-utf8", &o);
    o = options(), o.lens_text = "20 5 1.5 10\n-20 x 1 10\n", o.lens_text_size = strlen(o.lens_text);
    refuse("bad-text", &o);
    o.lens_text_size = 0;
    refuse("no-text", &o);
    o.lens_text_size = SIZE_MAX;
    refuse("endless-text", &o);
    o.lens_text_size = 4, o.lens_file = "dgauss.50mm";
    refuse("two-lenses", &o);
    o = options(), o.focus_distance = 10;
    refuse("too-near", &o);
    o = options(), o.film_diagonal = -1;
    refuse("range", &o);
    o = options(), o.weighting = "heavy";
    refuse("choice", &o);
    o = options(), o.weighting = "none", o.simple_weighting = 1;
    refuse("both", &o);
    o = options(), o.simple_weighting = 7;
    refuse("boolean", &o);
    o = options(), o.camera_to_world[5] = 0;
    refuse("singular", &o);

    realistic_camera_info info;
    realistic_camera *camera;
    o = options();
    camera = build(&o);
    info.struct_size = 4;
    report("info-small", api.get_info(camera, &info));
    info.struct_size = 4096;
    report("info-large", api.get_info(camera, &info));
    report("info-null", api.get_info(camera, NULL));
    report("info-no-camera", api.get_info(NULL, &info));
    report("name-null", api.get_lens_name(camera, NULL, 3, NULL));
    report("plan-null", api.plan(camera, NULL, 3, NULL));
    report("plan-no-camera", api.plan(NULL, NULL, 0, NULL));
    api.camera_free(camera);
    api.camera_free(NULL);
}

static void do_info(void) {
    realistic_options o = options();
    o.lens_file = "wide.22mm@35mm", o.film_distance = 40, o.film_diagonal = 20, o.fnumber = 8;
    realistic_camera *camera = build(&o);
    /* The structure starts one byte off: nothing needs to be aligned. */
    union { double aligned; char bytes[sizeof(realistic_camera_info) + 1]; } space;
    realistic_camera_info info;
    memset(&info, 0xA5, sizeof info);
    info.struct_size = sizeof info;
    memcpy(space.bytes + 1, &info, sizeof info);
    report("status", api.get_info(camera, (realistic_camera_info *)(void *)(space.bytes + 1)));
    memcpy(&info, space.bytes + 1, sizeof info);
    printf("info %d %u %.17g %.17g %.17g %.17g %.17g\n", info.struct_size == sizeof info, (unsigned)info.interfaces,
           info.focal_length_mm, info.fnumber, info.film_distance, info.focus_distance_mm,
           info.film_diagonal);
    char name[64];
    size_t length = 0;
    for (size_t capacity = 0; capacity < 20; capacity += 5) {
        memset(name, '~', sizeof name);
        name[sizeof name - 1] = '\0';
        if (api.get_lens_name(camera, capacity == 0 ? NULL : name, capacity, &length)) exit(3);
        if (name[capacity] != '~') printf("overrun %zu\n", capacity);
        printf("name %zu %zu %s\n", capacity, length, capacity == 0 ? "" : name);
    }
    api.camera_free(camera);
    o = options();
    o.lens_text = "50\n20 5 1.5 10\n-20 30 1 10\n# not part of the text", o.lens_text_size = 27;
    camera = build(&o);
    if (api.get_lens_name(camera, name, sizeof name, NULL)) exit(3);
    if (api.get_info(camera, &info)) exit(3);
    printf("text %s %u %.17g\n", name, (unsigned)info.interfaces, info.film_distance);
    api.camera_free(camera);
}

/* Prints the plan of a camera with a tolerance, one line per effect; the first call returns the plan's length. */
static void do_plan(void) {
    int calls = 0;
    realistic_options o = options();
    o.tolerance = -1;
    refuse("negative", &o);
    o.tolerance = 0.5, o.fnumber = 8;
    o.log = log_to_stdout, o.log_user = &calls;
    realistic_camera *camera = build(&o);
    size_t length = 0, again = 0;
    report("length", api.plan(camera, NULL, 0, &length));
    char *text = malloc(length + 1);
    if (text == NULL) exit(3);
    report("text", api.plan(camera, text, length + 1, &again));
    printf("lengths %d %d\n", again == length, strlen(text) == length);
    for (char *line = strtok(text, "\n"); line != NULL; line = strtok(NULL, "\n")) printf("line %s\n", line);
    char little[5] = "~~~~";
    report("cut", api.plan(camera, little, 4, NULL));
    printf("little %u\n", (unsigned)strlen(little));
    free(text);
    api.camera_free(camera);
}

static void do_log(void) {
    int calls = 0;
    realistic_options o = options();
    o.log = log_to_stdout, o.log_user = &calls;
    o.pupil = "disk", o.aperture_diameter = 99;
    realistic_camera *camera = build(&o);
    printf("calls %d\n", calls);
    api.camera_free(camera);
    o.film_diagonal = 0;
    refuse("refused", &o);
    o = options();
    o.pupil = "disk";
    api.camera_free(build(&o));
}

#define N 3000
/* Structures of the host, with the sizes of pbrt-v1's. */
typedef struct { realistic_sample sample; char rest[68]; } host_sample;

static realistic_sample sample_at(unsigned i) {
    /* The powers of the golden ratio's generalisation: a sequence that fills the cube of four numbers (M. Roberts's
       R4). */
    realistic_sample s;
    double n = i + 0.5;
    s.image_x = (float)(46 * (n * 0.856674883854503 - (double)(long)(n * 0.856674883854503))) - 3;
    s.image_y = (float)(36 * (n * 0.733891856627126 - (double)(long)(n * 0.733891856627126))) - 3;
    s.lens_u = (float)(n * 0.628706721038183 - (double)(long)(n * 0.628706721038183));
    s.lens_v = (float)(n * 0.538599255472409 - (double)(long)(n * 0.538599255472409));
    s.time = (float)(i % 3) / 2;
    return s;
}

static realistic_ray untouched(void) {
    realistic_ray ray;
    memset(&ray, 0x5A, sizeof ray);
    return ray;
}

static int differ(const realistic_ray *a, const realistic_ray *b, float wa, float wb) {
    return memcmp(a, b, sizeof *a) != 0 || memcmp(&wa, &wb, sizeof wa) != 0;
}

static void compare(const realistic_camera *camera) {
    static realistic_sample samples[N];
    static realistic_ray one[N], two[N], tight[N], exact[N];
    static float weight[N], weight_two[N], weight_tight[N], weight_exact[N], weight_odd[N];
    static realistic_reason reason[N], reason_soa[N];
    static host_sample spread[N];
    static char odd_samples[N * 21 + 1], odd_rays[N * 37 + 1], odd_weights[N * 4 + 1];
    int bad[6] = {0}, counts[8] = {0};

    for (unsigned i = 0; i < N; ++i) {
        samples[i] = spread[i].sample = sample_at(i);
        memcpy(odd_samples + 1 + 21 * i, &samples[i], sizeof samples[i]);
        one[i] = two[i] = tight[i] = exact[i] = untouched();
        memcpy(odd_rays + 1 + 37 * i, &one[i], sizeof one[i]);
        weight[i] = api.ray(camera, &samples[i], NULL, &one[i]);
        weight_two[i] = api.plain_ray(camera, &samples[i], &two[i]);
    }
    report("tight", realistic_camera_generate_rays(camera, N, samples, 0, tight, 0, weight_tight, reason));
    report("strides", realistic_camera_generate_rays(camera, N, &spread[0].sample, 88, exact, 36, weight_exact, NULL));
    report("odd", realistic_camera_generate_rays(camera, N, (realistic_sample *)(void *)(odd_samples + 1), 21,
                           (realistic_ray *)(void *)(odd_rays + 1), 37,
                           (float *)(void *)(odd_weights + 1), NULL));
    memcpy(weight_odd, odd_weights + 1, sizeof weight_odd);

    /* Structure of arrays: five arrays in, eleven out. */
    static float in[5][N], out[10][N];
    for (unsigned i = 0; i < N; ++i) {
        in[0][i] = samples[i].image_x, in[1][i] = samples[i].image_y;
        in[2][i] = samples[i].lens_u, in[3][i] = samples[i].lens_v, in[4][i] = samples[i].time;
    }
    memset(out, 0x5A, sizeof out);
    realistic_samples_soa soa_in = {in[0], in[1], in[2], in[3], in[4]};
    realistic_rays_soa soa_out = {out[0], out[1], out[2], out[3], out[4], out[5],
                                  out[6], out[7], out[8], out[9], reason_soa};
    report("soa", realistic_camera_generate_rays_soa(camera, N, &soa_in, &soa_out));

    for (unsigned i = 0; i < N; ++i) {
        realistic_ray odd, soa;
        memcpy(&odd, odd_rays + 1 + 37 * i, sizeof odd);
        for (int k = 0; k < 3; ++k) soa.o[k] = out[k][i], soa.d[k] = out[3 + k][i];
        soa.mint = out[6][i], soa.maxt = out[7][i], soa.time = out[8][i];
        bad[0] += differ(&one[i], &two[i], weight[i], weight_two[i]);
        bad[1] += differ(&one[i], &tight[i], weight[i], weight_tight[i]);
        bad[2] += differ(&one[i], &exact[i], weight[i], weight_exact[i]);
        bad[3] += differ(&one[i], &odd, weight[i], weight_odd[i]);
        bad[4] += differ(&one[i], &soa, weight[i], out[9][i]) || reason[i] != reason_soa[i];
        /* A blocked ray is unchanged and has a reason; a passing one has a weight and no reason. */
        realistic_ray as_it_was = untouched();
        int blocked = memcmp(&one[i], &as_it_was, sizeof as_it_was) == 0;
        bad[5] += blocked ? weight[i] != 0 || reason[i] == 0 : !(weight[i] > 0) || reason[i] != 0;
        if (reason[i] >= 0 && reason[i] < 8) ++counts[reason[i]];
    }
    printf("differences %d %d %d %d %d %d\n", bad[0], bad[1], bad[2], bad[3], bad[4], bad[5]);
    printf("reasons %d %d %d %d %d %d\n", counts[0], counts[1], counts[2], counts[3], counts[4], counts[5]);

    /* Only the required members. */
    memset(out[9], 0, sizeof out[9]);
    soa_out.mint = soa_out.maxt = soa_out.time = NULL, soa_out.reason = NULL;
    report("sparse", realistic_camera_generate_rays_soa(camera, N, &soa_in, &soa_out));
    printf("sparse-weights %d\n", memcmp(out[9], weight, sizeof weight) != 0);
}

/* Whether a neighbour differs from the ray of a separate call or, if that ray is blocked, from the ray itself. */
static int wrong_neighbour(const realistic_camera *camera, const realistic_sample *sample, const realistic_ray *own,
                           int has, const float *o, const float *d) {
    realistic_ray ray;
    int passes = api.ray(camera, sample, NULL, &ray) > 0;
    if (!passes) ray = *own;
    return passes != (has != 0) || memcmp(ray.o, o, sizeof ray.o) != 0 || memcmp(ray.d, d, sizeof ray.d) != 0;
}

/* A batch with neighbours, in structures or in separate arrays; `rx` and `ry` are the neighbours' weights. */
static realistic_request beside(realistic_ray_differential *rays, float *rx, float *ry, realistic_request request) {
    const ptrdiff_t step = sizeof *rays, number = sizeof(float);
    const realistic_output rx_o = {&rays->rx_o[0], &rays->rx_o[1], &rays->rx_o[2], step};
    const realistic_output rx_d = {&rays->rx_d[0], &rays->rx_d[1], &rays->rx_d[2], step};
    const realistic_output ry_o = {&rays->ry_o[0], &rays->ry_o[1], &rays->ry_o[2], step};
    const realistic_output ry_d = {&rays->ry_d[0], &rays->ry_d[1], &rays->ry_d[2], step};
    const realistic_output rx_w = {rx, NULL, NULL, number}, ry_w = {ry, NULL, NULL, number};
    request.rx_origin = rx_o, request.rx_direction = rx_d, request.rx_weight = rx_w;
    request.ry_origin = ry_o, request.ry_direction = ry_d, request.ry_weight = ry_w;
    return request;
}

static void do_differentials(void) {
    static realistic_sample samples[N];
    static realistic_ray_differential one[N], many[N];
    static float weight[N], weights[N], in[5][N], out[24][N];
    static realistic_reason reason[N];
    int bad[4] = {0}, counts[5] = {0};
    realistic_options o = options();
    /* Some samples of the disk are blocked. */
    o.fnumber = 4, o.pupil = "disk";
    realistic_camera *camera = build(&o);
    for (unsigned i = 0; i < N; ++i) {
        realistic_ray single = untouched();
        realistic_ray_differential *ray = &one[i];
        samples[i] = sample_at(i);
        memset(ray, 0x5A, sizeof *ray);
        many[i] = *ray;
        ray->struct_size = sizeof *ray;
        weight[i] = api.differential(camera, &samples[i], NULL, ray);
        float alone = api.ray(camera, &samples[i], NULL, &single);
        bad[0] += differ(&single, &ray->ray, alone, weight[i]);
        ++counts[weight[i] > 0 ? ray->has & 3 : 4];
        if (weight[i] > 0) {
            realistic_sample right = samples[i], below = samples[i];
            right.image_x += 1, below.image_y += 1;
            bad[1] += wrong_neighbour(camera, &right, &single, ray->has & REALISTIC_HAS_RX, ray->rx_o, ray->rx_d) +
                      wrong_neighbour(camera, &below, &single, ray->has & REALISTIC_HAS_RY, ray->ry_o, ray->ry_d);
        }
        for (int k = 0; k < 5; ++k) in[k][i] = (&samples[i].image_x)[k];
    }
    static float rx[N], ry[N];
    realistic_request request;
    realistic_request_of_structures(&request, samples, 0, &many[0].ray, sizeof many[0], weights, reason);
    request = beside(many, rx, ry, request);
    report("many", api.batch(camera, N, &request));
    for (unsigned i = 0; i < N; ++i) {
        uint32_t has = (rx[i] > 0 ? REALISTIC_HAS_RX : 0) | (ry[i] > 0 ? REALISTIC_HAS_RY : 0);
        if (weights[i] > 0) many[i].has = has;
    }
    realistic_samples_soa from = {in[0], in[1], in[2], in[3], in[4]};
    realistic_rays_soa to;
    memset(&to, 0, sizeof to);
    to.ox = out[0], to.oy = out[1], to.oz = out[2], to.dx = out[3], to.dy = out[4], to.dz = out[5], to.weight = out[6];
    to.time = out[21];
    realistic_request_of_arrays(&request, &from, &to);
    for (int k = 1; k < 3; ++k) {
        float(*column)[N] = out + 7 * k;
        const realistic_output origin = {column[0], column[1], column[2], sizeof(float)};
        const realistic_output direction = {column[3], column[4], column[5], sizeof(float)};
        const realistic_output weight_of = {column[6], NULL, NULL, sizeof(float)};
        *(k == 1 ? &request.rx_origin : &request.ry_origin) = origin;
        *(k == 1 ? &request.rx_direction : &request.ry_direction) = direction;
        *(k == 1 ? &request.rx_weight : &request.ry_weight) = weight_of;
    }
    report("soa", api.batch(camera, N, &request));
    for (unsigned i = 0; i < N; ++i) {
        many[i].struct_size = one[i].struct_size;
        bad[2] += memcmp(&one[i], &many[i], sizeof one[i]) != 0 || weight[i] != weights[i] ||
                  (weight[i] > 0) != (reason[i] == REALISTIC_REASON_OK);
        bad[3] += weight[i] != out[6][i];
        if (!(weight[i] > 0)) {
            bad[3] += out[13][i] != 0 || out[20][i] != 0 || out[7][i] != 0;
            continue;
        }
        bad[3] += (out[13][i] > 0) != ((one[i].has & REALISTIC_HAS_RX) != 0) ||
                  (out[20][i] > 0) != ((one[i].has & REALISTIC_HAS_RY) != 0) || out[21][i] != one[i].ray.time;
        for (int k = 0; k < 3; ++k) {
            bad[3] += out[k][i] != one[i].ray.o[k] || out[3 + k][i] != one[i].ray.d[k] ||
                      out[7 + k][i] != one[i].rx_o[k] || out[10 + k][i] != one[i].rx_d[k] ||
                      out[14 + k][i] != one[i].ry_o[k] || out[17 + k][i] != one[i].ry_d[k];
        }
    }
    printf("differences %d %d %d %d\n", bad[0], bad[1], bad[2], bad[3]);
    printf("neighbours %d %d %d %d %d\n", counts[0], counts[1], counts[2], counts[3], counts[4]);

    /* Requests that are refused, and leave the arrays unchanged. */
    realistic_ray_differential ray = one[0], before;
    ray.struct_size = sizeof ray - 1;
    before = ray;
    realistic_sample middle = {20, 15, 0.5f, 0.5f, 0};
    printf("zero %g %g %g %g\n", api.differential(camera, &middle, NULL, &ray), api.differential(NULL, &middle, NULL, &ray),
           api.differential(camera, NULL, NULL, &ray), api.differential(camera, &middle, NULL, NULL));
    printf("touched %d\n", memcmp(&ray, &before, sizeof ray) != 0);
    /* A request asks for both neighbours or none. */
    request.ry_direction.z = NULL;
    report("no-ry-dz", api.batch(camera, 1, &request));
    request.rx_origin.x = NULL;
    report("no-rx", api.batch(camera, 1, &request));
    /* With a request, the failure has a message. */
    memset(&request, 0, sizeof request);
    request.struct_size = sizeof request;
    report("size", api.differential(camera, &middle, &request, &ray) == 0 ? REALISTIC_STATUS_STRUCT_SIZE : 0);
    request.wavelengths_per_sample = 4;
    report("no-wavelengths", api.ray(camera, &middle, &request, &ray.ray) == 0 ? REALISTIC_STATUS_NULL_POINTER : 0);
    api.camera_free(camera);
}

static void do_rays(void) {
    realistic_options o = options();
    realistic_camera *camera = build(&o);
    compare(camera);
    api.camera_free(camera);
    o.lens_file = "fisheye.10mm", o.film_diagonal = 30, o.disk = "rejection", o.mm_per_unit = 1000;
    camera = build(&o);
    compare(camera);
    api.camera_free(camera);
    /* Rays are reflected in a steep plano-convex lens; a wide gap with small apertures lets rays miss the sphere. The
     * true pupil of this lens excludes most of these rays. */
    o = options();
    o.lens_text = "0 6 1.9 30\n-8 3 1 15.9\n6 4 1.9 11.9\n0 0 1 30\n", o.lens_text_size = strlen(o.lens_text);
    o.film_distance = 6, o.film_diagonal = 20, o.pupil = "rear";
    camera = build(&o);
    compare(camera);
    api.camera_free(camera);
}

static void do_lens(void) {
    double foreign[16] = {1, 2, 3}, film_distance = 7;
    report("no-lens", api.lens_focus((realistic_lens *)(void *)foreign, 900, &film_distance));
    report("null-lens", api.lens_focus(NULL, 900, &film_distance));
    printf("kept %g\n", film_distance);
}

static void do_null(void) {
    realistic_options o = options();
    realistic_camera *camera = build(&o);
    realistic_sample s = {20, 15, 0.5f, 0.5f, 0};
    realistic_ray ray = untouched(), before = ray;
    float weight = 7, in[1] = {20}, out[1];
    double foreign[16] = {1, 2, 3};
    realistic_camera *other = (realistic_camera *)(void *)foreign;
    printf("zero %g %g %g %g\n", api.ray(NULL, &s, NULL, &ray), api.ray(camera, NULL, NULL, &ray),
           api.ray(camera, &s, NULL, NULL), api.ray(other, &s, NULL, &ray));
    printf("zero-plain %g %g %g %g\n", api.plain_ray(NULL, &s, &ray), api.plain_ray(camera, NULL, &ray),
           api.plain_ray(camera, &s, NULL), api.plain_ray(other, &s, &ray));
    printf("touched %d\n", memcmp(&ray, &before, sizeof ray) != 0);
    report("no-camera", realistic_camera_generate_rays(NULL, 1, &s, 0, &ray, 0, &weight, NULL));
    report("foreign", realistic_camera_generate_rays(other, 1, &s, 0, &ray, 0, &weight, NULL));
    report("misaligned", realistic_camera_generate_rays((realistic_camera *)(void *)((char *)foreign + 1), 1, &s, 0, &ray, 0, &weight, NULL));
    report("no-samples", realistic_camera_generate_rays(camera, 1, NULL, 0, &ray, 0, &weight, NULL));
    report("no-rays", realistic_camera_generate_rays(camera, 1, &s, 0, NULL, 0, &weight, NULL));
    report("no-weights", realistic_camera_generate_rays(camera, 1, &s, 0, &ray, 0, NULL, NULL));
    report("short-stride", realistic_camera_generate_rays(camera, 2, &s, 19, &ray, 0, &weight, NULL));
    report("short-ray", realistic_camera_generate_rays(camera, 2, &s, 0, &ray, 35, &weight, NULL));
    report("overflow", realistic_camera_generate_rays(camera, SIZE_MAX / 8, &s, 88, &ray, 0, &weight, NULL));
    printf("kept %g\n", weight);
    report("none", realistic_camera_generate_rays(camera, 0, NULL, 0, NULL, 0, NULL, NULL));
    realistic_samples_soa soa_in = {in, in, in, in, in};
    realistic_rays_soa soa_out = {out, out, out, out, out, out, NULL, NULL, NULL, out, NULL};
    report("soa-none", realistic_camera_generate_rays_soa(camera, 0, &soa_in, &soa_out));
    report("soa-no-camera", realistic_camera_generate_rays_soa(NULL, 1, &soa_in, &soa_out));
    report("soa-no-samples", realistic_camera_generate_rays_soa(camera, 1, NULL, &soa_out));
    report("soa-no-rays", realistic_camera_generate_rays_soa(camera, 1, &soa_in, NULL));
    soa_in.lens_v = NULL;
    report("soa-no-lens-v", realistic_camera_generate_rays_soa(camera, 1, &soa_in, &soa_out));
    soa_in.lens_v = in, soa_out.dy = NULL;
    report("soa-no-dy", realistic_camera_generate_rays_soa(camera, 1, &soa_in, &soa_out));
    api.camera_free(other);
    printf("free-foreign %s\n", api.last_error());
    api.camera_free(camera);
}

static double unasked(void *user, const realistic_ray *ray) {
    (void)user, (void)ray;
    printf("asked\n");
    return 1000;
}

/* Numbers of elements for which no process has memory, or no machine has addresses. */
static void do_counts(void) {
    realistic_options o = options();
    realistic_camera *camera = build(&o);
    float in[1] = {20}, out[1] = {7};
    realistic_samples_soa soa_in = {in, in, in, in, in};
    realistic_rays_soa soa_out = {out, out, out, out, out, out, NULL, NULL, NULL, out, NULL};
    report("soa-endless", realistic_camera_generate_rays_soa(camera, SIZE_MAX / 4 - 1, &soa_in, &soa_out));
    /* 2^50 floats are 4 PiB, and 2^50 rays 36 PiB: no process has memory for all of them. */
    report("soa-many", realistic_camera_generate_rays_soa(camera, (size_t)1 << 50, &soa_in, &soa_out));
    realistic_sample sample = {20, 15, 0.5f, 0.5f, 0};
    realistic_ray ray = untouched();
    report("many", realistic_camera_generate_rays(camera, (size_t)1 << 50, &sample, 0, &ray, 0, out, NULL));
    realistic_request request;
    realistic_request_of_structures(&request, &sample, 0, &ray, 0, out, NULL);
    request.origin.stride = PTRDIFF_MAX;
    report("wide", api.batch(camera, 2, &request));
    request.origin.stride = PTRDIFF_MIN;
    report("wide-back", api.batch(camera, 2, &request));
    /* Element 1 would lie below address 0. */
    request.origin.stride = 36, request.time.x = (const float *)(uintptr_t)4096, request.time.stride = -8192;
    report("below", api.batch(camera, 2, &request));
    realistic_request_of_structures(&request, &sample, 0, &ray, 0, out, NULL);
    request.wavelengths_per_sample = UINT32_MAX, request.wavelength.x = in;
    report("wavelengths", api.batch(camera, SIZE_MAX / 8, &request));
    realistic_zone zone = {0, 0, 40, 30};
    double film = 7;
    report("zones-endless", api.autofocus(&o, &zone, SIZE_MAX / 4 - 1, 0, unasked, NULL, NULL, &film));
    report("zones-many", api.autofocus(&o, &zone, (size_t)1 << 42, 0, unasked, NULL, NULL, &film));
    report("zones-null", api.autofocus(&o, NULL, 1, 0, unasked, NULL, NULL, &film));
    printf("kept %g %g\n", (double)out[0], film);
    api.camera_free(camera);
}

struct work {
    const realistic_camera *camera;
    int number;
    unsigned long long hash;
    char message[256];
};

static void *worker(void *argument) {
    struct work *work = argument;
    /* This thread's call fails, and rays follow: the message of the failure is still the last one here. */
    char name[32];
    snprintf(name, sizeof name, "lens-of-thread-%d", work->number);
    realistic_options o = options();
    o.lens_file = name;
    realistic_camera *none = NULL;
    if (api.camera_new(&o, &none) == REALISTIC_STATUS_OK) exit(3);
    work->hash = 1469598103934665603ULL;
    for (unsigned i = 0; i < 20000; ++i) {
        realistic_sample s = sample_at(i);
        realistic_ray ray = untouched();
        float weight = api.ray(work->camera, &s, NULL, &ray);
        unsigned char bytes[sizeof ray + sizeof weight];
        memcpy(bytes, &ray, sizeof ray);
        memcpy(bytes + sizeof ray, &weight, sizeof weight);
        for (size_t k = 0; k < sizeof bytes; ++k) work->hash = (work->hash ^ bytes[k]) * 1099511628211ULL;
    }
    snprintf(work->message, sizeof work->message, "%s", api.last_error());
    return NULL;
}

static void do_threads(void) {
    enum { COUNT = 4 };
    realistic_options o = options();
    realistic_camera *camera = build(&o);
    struct work work[COUNT];
    pthread_t thread[COUNT];
    for (int i = 0; i < COUNT; ++i) {
        work[i].camera = camera, work[i].number = i;
        if (pthread_create(&thread[i], NULL, worker, &work[i]) != 0) exit(3);
    }
    for (int i = 0; i < COUNT; ++i) {
        pthread_join(thread[i], NULL);
        printf("thread %llu %s\n", work[i].hash, work[i].message);
    }
    printf("main [%s]\n", api.last_error());
    api.camera_free(camera);
}

int main(int count, char **argument) {
    static const struct { const char *name; void (*run)(void); } actions[] = {
        {"library", do_library}, {"refusals", do_refusals}, {"info", do_info}, {"log", do_log}, {"plan", do_plan},
        {"differentials", do_differentials},
        {"rays", do_rays},
        {"lens", do_lens},
        {"null", do_null},       {"threads", do_threads}, {"counts", do_counts},
    };
    if (count != 3) return 1;
    load(argument[1]);
    for (size_t i = 0; i < sizeof actions / sizeof actions[0]; ++i) {
        if (strcmp(argument[2], actions[i].name) == 0) {
            actions[i].run();
            return 0;
        }
    }
    return 1;
}
