// The parts of Open Shading Language that a shader of `realistic blender` uses, in C++, with single precision and
// safe roots.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

namespace osl {

struct vec {
    float v[3];
    vec(float all = 0) : v{all, all, all} {}
    vec(float x, float y, float z) : v{x, y, z} {}
    float operator[](int i) const { return v[i]; }
};
inline vec operator/(vec a, float b) { return vec(a[0] / b, a[1] / b, a[2] / b); }
inline vec operator*(vec a, float b) { return vec(a[0] * b, a[1] * b, a[2] * b); }
typedef vec point;
typedef vec vector;
typedef vec color;

inline float dot(vec a, vec b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline vec cross(vec a, vec b) {
    return vec(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
}

inline float sqrt(float x) { return x > 0 ? std::sqrt(x) : 0.0f; }
inline float log(float x) { return std::log(x); }
inline float exp(float x) { return std::exp(x); }
inline float abs(float x) { return std::fabs(x); }
inline float min(float a, float b) { return b < a ? b : a; }
inline float max(float a, float b) { return a < b ? b : a; }
inline int min(int a, int b) { return b < a ? b : a; }
inline int max(int a, int b) { return a < b ? b : a; }
inline float clamp(float x, float low, float high) { return min(max(x, low), high); }
inline float mix(float a, float b, float t) { return a * (1 - t) + b * t; }
inline float smoothstep(float from, float to, float x) {
    float t = clamp((x - from) / (to - from), 0, 1);
    return t * t * (3 - 2 * t);
}
inline void sincos(float angle, float &sine, float &cosine) {
    sine = std::sin(angle);
    cosine = std::cos(angle);
}

// The data of a sample: its raster and lens coordinates, and the camera's settings.
struct Sample {
    float raster[2], lens[2], aperture_size, focal_distance, sensor[2], hash;
};
static Sample sample;

inline point camera_shader_raster_position() { return point(sample.raster[0], sample.raster[1], 0); }
inline point camera_shader_random_sample() { return point(sample.lens[0], sample.lens[1], 0); }
inline float noise(const char *, point, float) { return sample.hash; }
inline int getattribute(const char *name, float &value) {
    bool is_size = !std::strcmp(name, "cam:aperture_size");
    if (!is_size && std::strcmp(name, "cam:focal_distance")) return 0;
    value = is_size ? sample.aperture_size : sample.focal_distance;
    return 1;
}
inline int getattribute(const char *name, vector &value) {
    if (!std::strcmp(name, "cam:sensor_size")) value = vector(sample.sensor[0], sample.sensor[1], 0);
    else return 0;
    return 1;
}

// A picture of 300 by 200 pixels.
inline float Dx(float) { return 1.0f / 300; }
inline float Dy(float) { return 1.0f / 200; }

// The inputs of the trace: stop, wavelength, x, y and direction. All are 0 before the trace.
static float traced[8];

// Focal length in mm; 0 stands for the shader's own.
static float requested_zoom = 0;

// Reads samples from standard input. For each sample, writes the throughput, position and direction, and the inputs
// of the trace. The text, if given, is the focal length.
template <class Shader> int serve(Shader shader, const char *zoom) {
    if (zoom) requested_zoom = std::strtof(zoom, nullptr);
    while (std::fread(&sample, sizeof sample, 1, stdin) == 1) {
        for (float &value : traced) value = 0;
        float out[9];
        shader(out);
        std::fwrite(out, sizeof out, 1, stdout);
        std::fwrite(traced, sizeof traced, 1, stdout);
    }
    return 0;
}

}
