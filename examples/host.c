/* A picture of a lens's vignetting: the mean weight of each pixel's rays, relative to that on the axis; and the width
 * in the scene that the middle pixel covers, by a ray with differentials.
 *
 *     cargo build --release
 *     cc -std=c99 -Iinclude examples/host.c -Ltarget/release -lrealistic -Wl,-rpath,target/release -o host
 *     ./host vignetting.pgm
 */
#include "realistic.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 64, HEIGHT = 48, LENS = 8 };

int main(int count, char **arguments) {
    realistic_options options;
    realistic_camera *camera;
    fprintf(stderr, "realistic %s, C ABI %u%s\n", realistic_version(), (unsigned)realistic_abi_version(),
            realistic_capabilities() & REALISTIC_CAPABILITY_PBRT_V1 ? ", loads in pbrt" : "");
    if (realistic_options_init(&options, sizeof options) == REALISTIC_STATUS_OK) {
        options.xres = WIDTH;
        options.yres = HEIGHT;
        options.lens_file = "dgauss.50mm";
        options.weighting = "relative";
    }
    if (realistic_camera_new(&options, &camera) != REALISTIC_STATUS_OK) {
        fprintf(stderr, "%s\n", realistic_last_error());
        return EXIT_FAILURE;
    }
    FILE *file = fopen(count > 1 ? arguments[1] : "vignetting.pgm", "wb");
    if (file == NULL) {
        perror("vignetting.pgm");
        realistic_camera_free(camera);
        return EXIT_FAILURE;
    }
    fprintf(file, "P5\n%d %d\n255\n", WIDTH, HEIGHT);
    for (int y = 0; y < HEIGHT; ++y) {
        for (int x = 0; x < WIDTH; ++x) {
            realistic_sample samples[LENS * LENS];
            realistic_ray rays[LENS * LENS];
            float weights[LENS * LENS];
            double sum = 0;
            for (int i = 0; i < LENS * LENS; ++i) {
                const realistic_sample sample = {x + 0.5f, y + 0.5f, (i % LENS + 0.5f) / LENS, (i / LENS + 0.5f) / LENS, 0};
                samples[i] = sample;
            }
            if (realistic_camera_generate_rays(camera, LENS * LENS, samples, 0, rays, 0, weights, NULL) ==
                REALISTIC_STATUS_OK) {
                for (int i = 0; i < LENS * LENS; ++i) sum += weights[i]; /* 0 where the lens blocks the ray */
            }
            double grey = 255 * sum / (LENS * LENS);
            fputc(grey < 255 ? (int)grey : 255, file);
        }
    }
    realistic_sample middle = {WIDTH / 2, HEIGHT / 2, 0.5f, 0.5f, 0};
    realistic_ray_differential ray;
    ray.struct_size = sizeof ray;
    if (realistic_generate_ray_differential(camera, &middle, NULL, &ray) > 0 && (ray.has & REALISTIC_HAS_RX) != 0) {
        printf("a pixel is %.3g mm wide at 10 m\n",
               fabs(ray.rx_o[0] - ray.ray.o[0] + 1e4 * (ray.rx_d[0] - ray.ray.d[0])));
    }
    realistic_camera_free(camera);
    return fclose(file) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
