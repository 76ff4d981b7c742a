/* A host that runs out of memory: builds cameras with less and less memory available. It also counts the process's
 * allocations during requests for rays. mod.rs runs it: PLUGIN ACTION. */

#define _GNU_SOURCE
#include "realistic.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#define N 300

/* The C library's own names of its allocator, so that this layer counts every call. */
void *__libc_malloc(size_t);
void *__libc_calloc(size_t, size_t);
void *__libc_realloc(void *, size_t);
void *__libc_memalign(size_t, size_t);

static long allocations;

void *malloc(size_t size) { return allocations++, __libc_malloc(size); }
void *calloc(size_t n, size_t size) { return allocations++, __libc_calloc(n, size); }
void *realloc(void *old, size_t size) { return allocations++, __libc_realloc(old, size); }
int posix_memalign(void **out, size_t alignment, size_t size) {
    void *block = __libc_memalign(alignment, size);
    allocations++;
    if (block != NULL) *out = block;
    return block == NULL ? 12 : 0;
}

static struct {
    realistic_status (*options_init)(realistic_options *, uint32_t);
    realistic_status (*camera_new)(const realistic_options *, realistic_camera **);
    void (*camera_free)(realistic_camera *);
    const char *(*last_error)(void);
    float (*ray)(const realistic_camera *, const realistic_sample *, const realistic_request *, realistic_ray *);
    float (*differential)(const realistic_camera *, const realistic_sample *, const realistic_request *,
                          realistic_ray_differential *);
    realistic_status (*batch)(const realistic_camera *, size_t, const realistic_request *);
} api;

static void resolve(void *library, const char *name, void *function) {
    void *symbol = dlsym(library, name);
    if (symbol == NULL) exit(2);
    memcpy(function, &symbol, sizeof symbol);
}

static realistic_options options(double tolerance) {
    realistic_options options;
    api.options_init(&options, sizeof options);
    options.xres = 30;
    options.yres = 20;
    options.tolerance = tolerance;
    return options;
}

/* Bytes of address space that the process uses. */
static rlim_t taken(void) {
    unsigned long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file == NULL || fscanf(file, "%lu", &pages) != 1) exit(2);
    fclose(file);
    return pages * 4096;
}

/* Builds a camera with some kB available, and prints the status and whether there is a camera. */
static void build(long kilobytes) {
    realistic_options given = options(0.0);
    realistic_camera *camera = NULL;
    realistic_status status;
    struct rlimit no_limit, limit;
    getrlimit(RLIMIT_AS, &no_limit);
    limit = no_limit;
    limit.rlim_cur = taken() + 1024UL * (unsigned long)kilobytes;
    setrlimit(RLIMIT_AS, &limit);
    status = api.camera_new(&given, &camera);
    setrlimit(RLIMIT_AS, &no_limit);
    printf("built %ld %d %d\n", kilobytes, status, camera != NULL);
    if (status != 0) printf("said %s\n", api.last_error());
    api.camera_free(camera);
}

static void out_of_memory(void) {
    long kilobytes;
    /* The smallest limit comes first: memory that a camera returns to the allocator may be enough for the next one. */
    for (kilobytes = 0; kilobytes < 12288; kilobytes += 256) build(kilobytes);
    build(1 << 16);
}

/* Counts the allocations by single rays and by batches. */
static void count(void) {
    static realistic_sample samples[N];
    static realistic_ray rays[N];
    static realistic_ray_differential differentials[N];
    static float weights[N];
    static realistic_reason reasons[N];
    static float beside[14][N];
    static float wavelengths[N];
    /* Cameras with ghosts and transmission, which aspheres carry from surface to surface. */
    const struct {
        const char *lens, *transmission;
        double tolerance, ghosts;
    } cameras[] = {
        {"dgauss.50mm", NULL, 0.0, 0.0},
        {"dgauss.50mm", NULL, 0.25, 0.0},
        {"dgauss.50mm", "quarter-wave", 0.0, 0.5},
        {"phone.4mm", "bare", 0.0, 0.5},
    };
    int i, j;
    for (j = 0; j < (int)(sizeof cameras / sizeof *cameras); j++) {
        realistic_options given = options(cameras[j].tolerance);
        realistic_camera *camera = NULL;
        realistic_request request;
        long before;
        given.lens_file = cameras[j].lens;
        if (cameras[j].transmission != NULL) {
            given.transmission = cameras[j].transmission;
            given.ghosts = cameras[j].ghosts;
        }
        if (api.camera_new(&given, &camera) != REALISTIC_STATUS_OK) exit(2);
        for (i = 0; i < N; i++) {
            wavelengths[i] = 450 + (float)(i % 200);
            samples[i].image_x = (float)(i % 30);
            samples[i].image_y = (float)(i / 15);
            samples[i].lens_u = (float)(i % 7) / 7;
            samples[i].lens_v = (float)(i % 11) / 11;
        }
        differentials[0].struct_size = sizeof differentials[0];
        /* The first request at a wavelength builds tables. */
        realistic_request_of_structures(&request, samples, 0, rays, 0, weights, reasons);
        request.wavelength.x = wavelengths, request.wavelength.stride = sizeof(float);
        api.batch(camera, 1, &request);
        before = allocations;
        api.batch(camera, N, &request);
        for (i = 0; i < N; i++) {
            api.ray(camera, &samples[i], NULL, &rays[i]);
            api.differential(camera, &samples[i], NULL, &differentials[0]);
        }
        realistic_request_of_structures(&request, samples, 0, rays, 0, weights, reasons);
        api.batch(camera, N, &request);
        /* Neighbours between arrays with other strides. */
        request.rx_origin.x = beside[0], request.rx_origin.y = beside[1], request.rx_origin.z = beside[2];
        request.rx_direction = request.rx_origin;
        request.rx_direction.x = beside[3], request.rx_direction.y = beside[4], request.rx_direction.z = beside[5];
        request.rx_weight.x = beside[6];
        request.rx_origin.stride = request.rx_direction.stride = request.rx_weight.stride = sizeof(float);
        request.ry_origin = request.rx_origin, request.ry_direction = request.rx_direction;
        request.ry_origin.x = beside[7], request.ry_origin.y = beside[8], request.ry_origin.z = beside[9];
        request.ry_direction.x = beside[10], request.ry_direction.y = beside[11], request.ry_direction.z = beside[12];
        request.ry_weight = request.rx_weight, request.ry_weight.x = beside[13];
        api.batch(camera, N, &request);
        printf("allocations %ld\n", allocations - before);
        api.camera_free(camera);
    }
    printf("all %ld\n", allocations);
}

int main(int argc, char **argv) {
    void *library = argc < 3 ? NULL : dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
    if (library == NULL) return 2;
    resolve(library, "realistic_options_init", &api.options_init);
    resolve(library, "realistic_camera_new", &api.camera_new);
    resolve(library, "realistic_camera_free", &api.camera_free);
    resolve(library, "realistic_last_error", &api.last_error);
    resolve(library, "realistic_generate_ray", &api.ray);
    resolve(library, "realistic_generate_ray_differential", &api.differential);
    resolve(library, "realistic_camera_generate_batch", &api.batch);
    if (strcmp(argv[2], "out") == 0) out_of_memory();
    else count();
    return 0;
}
