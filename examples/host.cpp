// A picture of a lens's vignetting: the mean weight of each pixel's rays, relative to that on the axis; and the width
// in the scene that the middle pixel covers, by a ray with differentials.
//
//     cargo build --release
//     c++ -std=c++11 -Iinclude examples/host.cpp -Ltarget/release -lrealistic -Wl,-rpath,target/release -o host
//     ./host vignetting.pgm

#include "realistic.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>

int main(int count, char **arguments) {
    const int width = 64, height = 48, lens = 8, rays = lens * lens;
    try {
        realistic::Options options(width, height);
        options.set(&realistic_options::lens_file, "dgauss.50mm");
        options.set(&realistic_options::weighting, "relative");
        options.log([](int32_t, const char *message) { std::cerr << message << '\n'; });
        const realistic::Camera camera(options);

        std::ofstream file(count > 1 ? arguments[1] : "vignetting.pgm", std::ios::binary);
        file << "P5\n" << width << ' ' << height << "\n255\n";
        std::vector<realistic_sample> samples(rays);
        std::vector<realistic_ray> out(rays);
        std::vector<float> weights(rays);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                for (int i = 0; i < rays; ++i) {
                    samples[i] = {x + 0.5f, y + 0.5f, (i % lens + 0.5f) / lens, (i / lens + 0.5f) / lens, 0};
                }
                camera.generate(samples.data(), rays, out.data(), weights.data());
                double sum = 0;
                for (float weight : weights) sum += weight; // 0 where the lens blocks the ray
                file.put(static_cast<char>(static_cast<int>(std::min(255.0, 255 * sum / rays))));
            }
        }
        realistic_ray_differential ray;
        if (camera.generate({width / 2, height / 2, 0.5f, 0.5f, 0}, ray) > 0 && (ray.has & REALISTIC_HAS_RX) != 0) {
            std::cout << "a pixel is " << std::abs(ray.rx_o[0] - ray.ray.o[0] + 1e4 * (ray.rx_d[0] - ray.ray.d[0]))
                      << " mm wide at 10 m\n";
        }
        return file.flush() ? EXIT_SUCCESS : EXIT_FAILURE;
    } catch (const realistic::Error &error) {
        std::cerr << error.what() << '\n';
        return EXIT_FAILURE;
    }
}
