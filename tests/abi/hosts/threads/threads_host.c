/* A host that forks while another of its threads builds tables on demand, and a host whose threads have small stacks.
 * mod.rs runs it: PLUGIN importance | wavelengths, or PLUGIN stack BYTES LENS... */

#define _GNU_SOURCE
#include "realistic.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define N 256
/* Seconds after which a child that has not ended must be waiting for a thread that exists only in its parent. */
#define PATIENCE 120

static struct {
    realistic_status (*options_init)(realistic_options *, uint32_t);
    realistic_status (*camera_new)(const realistic_options *, realistic_camera **);
    void (*camera_free)(realistic_camera *);
    const char *(*last_error)(void);
    float (*ray)(const realistic_camera *, const realistic_sample *, const realistic_request *, realistic_ray *);
    float (*differential)(const realistic_camera *, const realistic_sample *, const realistic_request *,
                          realistic_ray_differential *);
    realistic_status (*batch)(const realistic_camera *, size_t, const realistic_request *);
    realistic_status (*aim)(const realistic_camera *, size_t, const realistic_scene_points *, const realistic_aimed *,
                            const realistic_importance *);
} api;

static void resolve(void *library, const char *name, void *function) {
    void *symbol = dlsym(library, name);
    if (symbol == NULL) exit(2);
    memcpy(function, &symbol, sizeof symbol);
}

static realistic_camera *build(const char *lens, double tolerance) {
    realistic_options options;
    realistic_camera *camera = NULL;
    api.options_init(&options, sizeof options);
    options.xres = 30;
    options.yres = 20;
    options.lens_file = lens;
    options.tolerance = tolerance;
    if (api.camera_new(&options, &camera) != REALISTIC_STATUS_OK) {
        printf("refused %s\n", api.last_error());
        exit(2);
    }
    return camera;
}

/* Returns the density of a direction toward the lens. */
static float aim(const realistic_camera *camera) {
    float x = 0, y = 0, z = 3000, u = 0.4f, v = 0.6f;
    float direction[3], density = -1, raster[2], importance, densities[3];
    realistic_scene_points points;
    realistic_aimed aimed;
    realistic_importance found;
    memset(&points, 0, sizeof points);
    memset(&aimed, 0, sizeof aimed);
    memset(&found, 0, sizeof found);
    points.struct_size = sizeof points;
    points.point.x = &x, points.point.y = &y, points.point.z = &z, points.lens.x = &u, points.lens.y = &v;
    aimed.struct_size = sizeof aimed;
    aimed.direction.x = direction, aimed.direction.y = direction + 1, aimed.direction.z = direction + 2;
    aimed.density.x = &density;
    found.struct_size = sizeof found;
    found.image.x = raster, found.image.y = raster + 1, found.importance.x = &importance;
    found.density.x = densities, found.area_density.x = densities + 1, found.solid_angle_density.x = densities + 2;
    if (api.aim(camera, 1, &points, &aimed, &found) != REALISTIC_STATUS_OK) exit(2);
    return density;
}

/* Returns the weight of a ray at a wavelength. */
static float ray_at(const realistic_camera *camera) {
    realistic_sample sample = {15, 10, 0.5f, 0.5f, 0};
    realistic_ray ray;
    realistic_request request;
    float wavelength = 480;
    memset(&request, 0, sizeof request);
    request.struct_size = sizeof request;
    request.wavelength.x = &wavelength;
    return api.ray(camera, &sample, &request, &ray);
}

struct work {
    const realistic_camera *camera;
    float (*trace_one)(const realistic_camera *);
    float answer;
    int is_done;
};

static void *worker(void *argument) {
    struct work *work = argument;
    work->answer = work->trace_one(work->camera);
    __atomic_store_n(&work->is_done, 1, __ATOMIC_RELEASE);
    return NULL;
}

/* Forks some time after a thread requests a table that is built on demand, and lets the child request the table, too.
 * Returns whether the child was forked before the thread had its result. */
static int fork_after(double seconds, const char *lens, float (*trace_one)(const realistic_camera *)) {
    struct work work = {build(lens, 0.0), trace_one, -1, 0};
    pthread_t thread;
    float answer = -2;
    int status, was_done, ends[2];
    pid_t child;
    if (pipe(ends) != 0 || pthread_create(&thread, NULL, worker, &work) != 0) exit(3);
    usleep((useconds_t)(1e6 * seconds));
    fflush(stdout);
    child = fork();
    if (child == 0) {
        alarm(PATIENCE);
        answer = trace_one(work.camera);
        _exit(write(ends[1], &answer, sizeof answer) == sizeof answer ? 0 : 4);
    }
    was_done = __atomic_load_n(&work.is_done, __ATOMIC_ACQUIRE);
    if (child < 0 || waitpid(child, &status, 0) != child) exit(3);
    if (status != 0) {
        printf("child %s\n", WIFSIGNALED(status) ? strsignal(WTERMSIG(status)) : "failed");
        exit(0);
    }
    if (read(ends[0], &answer, sizeof answer) != sizeof answer) exit(3);
    close(ends[0]), close(ends[1]);
    pthread_join(thread, NULL);
    printf("answers %.9g %.9g\n", (double)work.answer, (double)answer);
    api.camera_free((realistic_camera *)work.camera);
    return !was_done;
}

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* Forks at several moments in the first half of the first request, since a busy machine wakes threads late. */
static void do_forks(int count, const char *lens, float (*trace_one)(const realistic_camera *)) {
    realistic_camera *camera = build(lens, 0.0);
    double start = now(), takes;
    int i, early = 0;
    trace_one(camera);
    takes = now() - start;
    api.camera_free(camera);
    for (i = 1; i <= count; ++i) early += fork_after(takes * i / (2 * count), lens, trace_one);
    printf("early %d\n", early);
}

/* Makes every call that uses much stack. */
static void *everything(void *lens) {
    static realistic_sample samples[N];
    static realistic_ray rays[N];
    realistic_ray_differential differential;
    static float weights[N], wavelengths[N];
    static realistic_reason reasons[N];
    static const double tolerances[] = {0.0, 0.25};
    float sum = 0;
    int i, j;
    for (i = 0; i < N; ++i) {
        samples[i].image_x = (float)(i % 30);
        samples[i].image_y = (float)(i % 20);
        samples[i].lens_u = (float)(i % 7) / 7;
        samples[i].lens_v = (float)(i % 11) / 11;
        wavelengths[i] = (float)(400 + i);
    }
    differential.struct_size = sizeof differential;
    for (j = 0; j < 2; ++j) {
        realistic_camera *camera = build(lens, tolerances[j]);
        realistic_ray ray;
        realistic_request request;
        realistic_request_of_structures(&request, samples, 0, rays, 0, weights, reasons);
        for (i = 0; i < N; ++i) sum += api.ray(camera, &samples[i], NULL, &ray);
        if (api.batch(camera, N, &request) != REALISTIC_STATUS_OK) exit(2);
        for (i = 0; i < N; ++i) sum -= weights[i];
        request.wavelength.x = wavelengths;
        request.wavelength.stride = sizeof wavelengths[0];
        if (api.batch(camera, N, &request) != REALISTIC_STATUS_OK) exit(2);
        for (i = 0; i < N; ++i) sum += api.differential(camera, &samples[i], NULL, &differential);
        sum += aim(camera);
        api.camera_free(camera);
    }
    printf("done %s %d\n", (const char *)lens, sum == sum);
    return NULL;
}

static void do_stack(size_t bytes, char **lenses) {
    pthread_attr_t attributes;
    pthread_t thread;
    pthread_attr_init(&attributes);
    if (pthread_attr_setstacksize(&attributes, bytes) != 0) exit(3);
    for (; *lenses != NULL; ++lenses) {
        if (pthread_create(&thread, &attributes, everything, *lenses) != 0) exit(3);
        pthread_join(thread, NULL);
        fflush(stdout);
    }
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
    resolve(library, "realistic_camera_sample_importance", &api.aim);
    if (strcmp(argv[2], "importance") == 0) do_forks(3, "dgauss.50mm", aim);
    else if (strcmp(argv[2], "wavelengths") == 0) do_forks(3, "phone.4mm", ray_at);
    else do_stack(strtoul(argv[3], NULL, 10), argv + 4);
    return 0;
}
