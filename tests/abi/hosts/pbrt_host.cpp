// A host that behaves towards a camera plugin as pbrt 1.05 does, written from the measured layouts and the order of
// calls. The tests compile it once for each std::string ABI, with its symbols exported like that renderer's.
//
// Arguments, in any order after the plugin's path and the action:
//   float:NAME=1,2  integer:NAME=1  bool:NAME=true  string:NAME=a|b    the scene's parameters, and
//   point:NAME=1,2,3  vector:, normal:, color: alike  texture:NAME=a    parameters of types that no camera looks up
//   file=PATH of the scene  res=WxH  w2c=16 numbers  sample=x,y,u,v,time (many)  spp=N
//   placements=N: number of placements, for the action of that name
//   traps=1: floating-point exceptions trap
// Prints lines of the form `key values…`, which the tests read.

#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <fenv.h>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

// --- symbols that a plugin finds in the process -----------------------------------------

#define SAY(name, word)                                                                            \
    void name(const char *format, ...) __attribute__((format(printf, 1, 2)));                      \
    void name(const char *format, ...) {                                                           \
        char text[4096];                                                                           \
        va_list arguments;                                                                         \
        va_start(arguments, format);                                                               \
        vsnprintf(text, sizeof text, format, arguments);                                           \
        va_end(arguments);                                                                         \
        std::printf("%s %s\n", word, text);                                                        \
    }
SAY(Info, "notice")
SAY(Warning, "warning")
SAY(Error, "error")
void Severe(const char *format, ...);
void Severe(const char *, ...) {
    std::printf("severe\n");
    std::fflush(stdout);
    std::abort();
}

template <class T> struct Item {
    std::string name;
    int count;
    T *values;
    bool used;
};

template <class T> struct Items {
    std::vector<Item<T> *> list;
    void add(const std::string &name, const std::vector<T> &values) {
        T *copy = new T[values.size()];
        for (std::size_t i = 0; i < values.size(); ++i) copy[i] = values[i];
        list.push_back(new Item<T>{name, int(values.size()), copy, false});
    }
    const T *find(const std::string &name, int *count) const {
        for (Item<T> *item : list)
            if (item->name == name) {
                *count = item->count;
                item->used = true;
                return item->values;
            }
        return nullptr;
    }
    void report_and_clear() {
        for (Item<T> *item : list) {
            if (!item->used) Warning("Parameter \"%s\" not used", item->name.c_str());
            delete[] item->values;
            delete item;
        }
        list.clear();
    }
};

struct Triple {
    float x, y, z;
};

class ParamSet {
public:
    const float *FindFloat(const std::string &, int *) const;
    const int *FindInt(const std::string &, int *) const;
    const bool *FindBool(const std::string &, int *) const;
    const std::string *FindString(const std::string &, int *) const;
    std::string ToString() const;

    Items<int> ints;
    Items<bool> bools;
    Items<float> floats;
    Items<Triple> points, vectors, normals, spectra;
    Items<std::string> strings, textures;
};
const float *ParamSet::FindFloat(const std::string &name, int *count) const { return floats.find(name, count); }
const int *ParamSet::FindInt(const std::string &name, int *count) const { return ints.find(name, count); }
const bool *ParamSet::FindBool(const std::string &name, int *count) const { return bools.find(name, count); }
const std::string *ParamSet::FindString(const std::string &name, int *count) const {
    return strings.find(name, count);
}

std::ostream &operator<<(std::ostream &text, const Triple &triple) {
    return text << triple.x << ' ' << triple.y << ' ' << triple.z;
}

// The items are written as in a scene file, in the renderer's order.
template <class T> void declare(std::ostream &text, const char *type, const Items<T> &items, const char *quote = "") {
    for (const Item<T> *item : items.list) {
        text << '"' << type << ' ' << item->name << "\" [";
        for (int i = 0; i < item->count; ++i) text << quote << item->values[i] << quote << ' ';
        text << "] ";
    }
}

std::string ParamSet::ToString() const {
    std::ostringstream text;
    text << std::boolalpha;
    declare(text, "integer", ints);
    declare(text, "bool", bools, "\"");
    declare(text, "float", floats);
    declare(text, "point", points);
    declare(text, "vector", vectors);
    declare(text, "normal", normals);
    declare(text, "string", strings, "\"");
    declare(text, "texture", textures, "\"");
    declare(text, "color", spectra);
    return text.str();
}

// The scene file that is being read.
std::string current_file;

struct Ray {
    Triple o, d;
    float mint, maxt, time;
};
struct RayDifferential : Ray {
    bool hasDifferentials;
    Ray rx, ry;
};
struct Sample {
    float imageX, imageY, lensU, lensV, time;
    std::vector<unsigned> n1D, n2D;
    float **oneD, **twoD;
};
struct Matrix4x4 {
    int nReferences;
    float m[4][4];
};
struct Transform {
    Matrix4x4 *m, *mInv;
};

int films_destroyed = 0;
int base_calls = 0;

class Film {
public:
    Film(int x, int y) : xResolution(x), yResolution(y) {}
    virtual ~Film() { ++films_destroyed; }
    virtual void AddSample(const Sample &, const Ray &, float radiance, float alpha) = 0;
    virtual void WriteImage() = 0;
    const int xResolution, yResolution;
};

class MeanFilm : public Film {
public:
    MeanFilm(int x, int y) : Film(x, y), pixels(std::size_t(x) * std::size_t(y)) {}
    void AddSample(const Sample &sample, const Ray &, float radiance, float alpha) override {
        int x = int(std::floor(sample.imageX)), y = int(std::floor(sample.imageY));
        if (x < 0 || y < 0 || x >= xResolution || y >= yResolution) return;
        Pixel &pixel = pixels[std::size_t(y) * std::size_t(xResolution) + std::size_t(x)];
        pixel.radiance += radiance, pixel.alpha += alpha, pixel.count += 1;
    }
    // Prints the mean pixel, whose colour is multiplied by its alpha, as in the renderer's image film.
    void WriteImage() override {
        double radiance = 0, alpha = 0, premultiplied = 0;
        for (const Pixel &pixel : pixels) {
            double r = pixel.radiance / pixel.count, a = std::fmin(1.0, std::fmax(0.0, pixel.alpha / pixel.count));
            radiance += r, alpha += a, premultiplied += r * a;
        }
        double n = double(pixels.size());
        std::printf("image %.9g %.9g %.9g\n", radiance / n, alpha / n, premultiplied / n);
    }

private:
    struct Pixel {
        double radiance = 0, alpha = 0, count = 0;
    };
    std::vector<Pixel> pixels;
};

class Camera {
public:
    virtual float GenerateRay(const Sample &sample, Ray *ray) const = 0;
    virtual ~Camera();
    Camera(const Transform &, float, float, float, float, Film *);
    Film *film;
    // These members are not private, as they are in the renderer: the tests read them.
    Transform WorldToCamera, CameraToWorld;
    float ClipHither, ClipYon, ShutterOpen, ShutterClose;
};
// A plugin may call both or neither; ours calls neither.
Camera::~Camera() {
    ++base_calls;
    delete film;
}
Camera::Camera(const Transform &w2c, float hither, float yon, float open, float close, Film *f)
    : film(f), WorldToCamera(w2c), CameraToWorld{w2c.mInv, w2c.m}, ClipHither(hither), ClipYon(yon),
      ShutterOpen(open), ShutterClose(close) {
    ++base_calls;
}

// A foreign camera, which the exported functions must refuse.
class ForeignCamera : public Camera {
public:
    ForeignCamera(const Transform &w2c, Film *f) : Camera(w2c, 0, 1, 0, 1, f) {}
    float GenerateRay(const Sample &, Ray *) const override { return 7; }
};

// --- this program ----------------------------------------------------------------------

struct Request {
    ParamSet params;
    int x = 30, y = 20, spp = 64, placements = 0;
    Matrix4x4 world_to_camera{1, {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
    Matrix4x4 camera_to_world = world_to_camera;
    std::vector<Sample> samples;
};

std::vector<std::string> split(const std::string &text, char separator) {
    std::vector<std::string> parts;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
    return parts;
}

std::vector<float> floats_of(const std::string &text) {
    std::vector<float> numbers;
    for (const std::string &part : split(text, ',')) numbers.push_back(std::strtof(part.c_str(), nullptr));
    return numbers;
}

struct Doubles {
    double m[4][4];
};

// The inverse in double precision, by elimination of [matrix | identity], column by column.
Doubles inverted(const Matrix4x4 &from) {
    double a[4][8] = {};
    for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c) a[r][c] = double(from.m[r][c]), a[r][4 + r] = 1;
    for (int column = 0; column < 4; ++column) {
        int pivot = column;
        for (int r = column; r < 4; ++r)
            if (std::fabs(a[r][column]) > std::fabs(a[pivot][column])) pivot = r;
        for (int c = 0; c < 8; ++c) std::swap(a[column][c], a[pivot][c]);
        for (int r = 0; r < 4; ++r) {
            double factor = r == column ? 0 : a[r][column] / a[column][column];
            for (int c = 0; c < 8; ++c) a[r][c] -= factor * a[column][c];
        }
    }
    Doubles to;
    for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c) to.m[r][c] = a[r][4 + c] / a[r][r];
    return to;
}

// The inverse as the renderer computes it: by Gauss-Jordan elimination in place, in single precision. The pivot of each
// step is the largest entry of the rows and columns that have had no pivot so far. A step solves the pivot's equation
// for its unknown and inserts the result into the other equations, so that one unknown and one right side change
// places; at the end the rows and columns are reordered.
Matrix4x4 inverted_in_single_precision(const Matrix4x4 &from) {
    Matrix4x4 to = from;
    float (&a)[4][4] = to.m;
    int row_of[4] = {-1, -1, -1, -1}, column_of[4] = {-1, -1, -1, -1};
    for (int step = 0; step < 4; ++step) {
        int p = -1, q = -1;
        for (int r = 0; r < 4; ++r)
            for (int c = 0; c < 4; ++c)
                if (column_of[r] < 0 && row_of[c] < 0 && (p < 0 || std::fabs(a[r][c]) > std::fabs(a[p][q])))
                    p = r, q = c;
        column_of[p] = q, row_of[q] = p;
        float reciprocal = 1 / a[p][q];
        a[p][q] = 1;
        for (int c = 0; c < 4; ++c) a[p][c] *= reciprocal;
        for (int r = 0; r < 4; ++r) {
            if (r == p) continue;
            float factor = a[r][q];
            a[r][q] = 0;
            for (int c = 0; c < 4; ++c) a[r][c] -= factor * a[p][c];
        }
    }
    Matrix4x4 ordered = to;
    for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c) ordered.m[r][c] = a[row_of[r]][column_of[c]];
    return ordered;
}

void take(Request *request, const std::string &argument) {
    std::size_t equals = argument.find('='), colon = argument.find(':');
    std::string key = argument.substr(0, equals), value = argument.substr(equals + 1);
    if (key == "res") {
        std::sscanf(value.c_str(), "%dx%d", &request->x, &request->y);
    } else if (key == "traps") {
        feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
    } else if (key == "file") {
        current_file = value;
    } else if (key == "spp") {
        request->spp = std::atoi(value.c_str());
    } else if (key == "placements") {
        request->placements = std::atoi(value.c_str());
    } else if (key == "w2c") {
        std::vector<float> numbers = floats_of(value);
        for (int i = 0; i < 16; ++i) request->world_to_camera.m[i / 4][i % 4] = numbers.at(std::size_t(i));
        Doubles inverse = inverted(request->world_to_camera);
        for (int i = 0; i < 16; ++i) request->camera_to_world.m[i / 4][i % 4] = float(inverse.m[i / 4][i % 4]);
    } else if (key == "sample") {
        std::vector<float> n = floats_of(value);
        request->samples.push_back(Sample{n.at(0), n.at(1), n.at(2), n.at(3), n.at(4), {}, {}, nullptr, nullptr});
    } else {
        std::string kind = argument.substr(0, colon), name = key.substr(colon + 1);
        if (kind == "float") request->params.floats.add(name, floats_of(value));
        if (kind == "integer") {
            std::vector<int> numbers;
            for (float number : floats_of(value)) numbers.push_back(int(number));
            request->params.ints.add(name, numbers);
        }
        if (kind == "bool") request->params.bools.add(name, {value == "true"});
        if (kind == "string") request->params.strings.add(name, split(value, '|'));
        if (kind == "texture") request->params.textures.add(name, {value});
        std::vector<float> n = floats_of(value);
        n.resize(3);
        Triple triple{n[0], n[1], n[2]};
        if (kind == "point") request->params.points.add(name, {triple});
        if (kind == "vector") request->params.vectors.add(name, {triple});
        if (kind == "normal") request->params.normals.add(name, {triple});
        if (kind == "color") request->params.spectra.add(name, {triple});
    }
}

using Create = Camera *(*)(const ParamSet &, const Transform &, Film *);
using Generate = float (*)(const void *, const void *, void *);

struct Plugin {
    Create create;
    Generate generate;
};

// A ray with the content that the renderer's rays have before each call.
Ray fresh_ray() { return Ray{{0, 0, 0}, {0, 0, 0}, 1e-3f, std::numeric_limits<float>::infinity(), 0}; }

void print_ray(const char *key, float weight, const Ray &ray) {
    std::printf("%s %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n", key, double(weight), double(ray.o.x),
                double(ray.o.y), double(ray.o.z), double(ray.d.x), double(ray.d.y), double(ray.d.z),
                double(ray.mint), double(ray.maxt), double(ray.time));
}

void rays(const Camera *camera, const Plugin &plugin, const std::vector<Sample> &samples) {
    for (const Sample &sample : samples) {
        Ray ray = fresh_ray(), exact = fresh_ray();
        float weight = camera->GenerateRay(sample, &ray);
        print_ray("vtable", weight, ray);
        weight = plugin.generate(camera, &sample, &exact);
        print_ray("exported", weight, exact);
    }
}

double low_discrepancy(unsigned n, unsigned base) {
    double value = 0, digit = 1.0 / base;
    for (; n > 0; n /= base, digit /= base) value += digit * (n % base);
    return value;
}

// Renders a scene of radiance 1 in all directions, with three camera calls per sample.
void render(const Camera *camera, const Plugin &plugin, int spp) {
    Film *film = camera->film;
    double irradiance = 0;
    unsigned n = 0, zero = 0, blocked = 0, differentials = 0, bad = 0;
    for (int y = 0; y < film->yResolution; ++y)
        for (int x = 0; x < film->xResolution; ++x)
            for (int s = 0; s < spp; ++s) {
                ++n;
                Sample sample{float(x + low_discrepancy(n, 2)), float(y + low_discrepancy(n, 3)),
                              float(low_discrepancy(n, 5)), float(low_discrepancy(n, 7)),
                              float(low_discrepancy(n, 11)), {}, {}, nullptr, nullptr};
                RayDifferential ray;
                static_cast<Ray &>(ray) = ray.rx = ray.ry = fresh_ray();
                ray.hasDifferentials = false;
                float weight = camera->GenerateRay(sample, &ray);
                ++sample.imageX;
                float weight_x = camera->GenerateRay(sample, &ray.rx);
                --sample.imageX;
                ++sample.imageY;
                float weight_y = camera->GenerateRay(sample, &ray.ry);
                if (weight_x > 0 && weight_y > 0) ray.hasDifferentials = true;
                --sample.imageY;
                // The renderer leaves alpha unset when the weight is 0. Alpha then has arbitrary bits of the stack, as
                // observed.
                float radiance = 0, alpha = 1e30f;
                if (weight > 0) {
                    radiance = weight * 1;
                    alpha = 1;
                } else {
                    ++zero;
                }
                film->AddSample(sample, ray, radiance, alpha);
                differentials += ray.hasDifferentials;
                for (const Ray *r : {static_cast<const Ray *>(&ray), static_cast<const Ray *>(&ray.rx),
                                     static_cast<const Ray *>(&ray.ry)}) {
                    double length = std::sqrt(double(r->d.x) * r->d.x + double(r->d.y) * r->d.y +
                                              double(r->d.z) * r->d.z);
                    bad += !(std::fabs(length - 1) < 1e-5) || !std::isfinite(r->o.x + r->o.y + r->o.z) ||
                           !(r->mint < r->maxt);
                }
                Ray exact = fresh_ray();
                float true_weight = plugin.generate(camera, &sample, &exact);
                blocked += true_weight == 0;
                irradiance += true_weight;
            }
    film->WriteImage();
    std::printf("irradiance %.9g\nsamples %u\nzero %u\nblocked %u\ndifferentials %u\nbad %u\n", irradiance / n, n,
                zero, blocked, differentials, bad);
}

// Random numbers in [0, 1), which are the same in every run.
struct Random {
    std::uint64_t state = 1;
    double next() {
        state = state * 6364136223846793005u + 1442695040888963407u;
        return double(state >> 11) / 9007199254740992.0;
    }
    double between(double from, double to) { return from + (to - from) * next(); }
};

// A matrix with a rotation, a uniform scale, a reflection (every other one) and a translation by up to 1e5 times that
// scale.
Matrix4x4 random_placement(Random *random) {
    double q[4], square = 0;
    do {
        square = 0;
        for (double &part : q) part = random->between(-1, 1), square += part * part;
    } while (square > 1 || square < 1e-3);
    double w = q[0], x = q[1], y = q[2], z = q[3], s = 2 / square;
    double scale = std::pow(10, random->between(-3, 3)), mirror = random->next() < 0.5 ? -1 : 1;
    double move = std::pow(10, random->between(-2, 5));
    double rows[3][3] = {{1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)},
                         {s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)},
                         {s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)}};
    Matrix4x4 matrix{1, {}};
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) matrix.m[r][c] = float(scale * rows[r][c] * (c == 0 ? mirror : 1));
        matrix.m[r][3] = float(move * random->between(-1, 1));
    }
    matrix.m[3][3] = 1;
    return matrix;
}

Matrix4x4 product(const Matrix4x4 &a, const Matrix4x4 &b) {
    Matrix4x4 made{1, {}};
    for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c)
            made.m[r][c] = a.m[r][0] * b.m[0][c] + a.m[r][1] * b.m[1][c] + a.m[r][2] * b.m[2][c] + a.m[r][3] * b.m[3][c];
    return made;
}

bool is_affine(const Matrix4x4 &matrix) {
    return matrix.m[3][0] == 0 && matrix.m[3][1] == 0 && matrix.m[3][2] == 0 && matrix.m[3][3] == 1;
}

// Cameras placed by random matrices: the distance of their rays from those of a camera without placement, transformed
// to the world by the camera-to-world matrix in double precision. A third of the matrices are given as world to camera,
// like a scene's matrix; a third as camera to world, like a scene's LookAt; and a third as world to camera by two
// matrices, the placement preceded by a translation.
void placements(const Plugin &plugin, const Request &request) {
    Random random;
    Matrix4x4 identity{1, {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
    Transform unplaced{&identity, &identity};
    Camera *reference = plugin.create(request.params, unplaced, new MeanFilm(request.x, request.y));
    double direction_error = 0, origin_error = 0;
    int refused = 0, rounded = 0;
    for (int i = 0; i < request.placements; ++i) {
        Matrix4x4 world_to_camera = random_placement(&random), camera_to_world;
        Doubles truth;
        if (i % 3 == 1) {
            camera_to_world = world_to_camera;
            world_to_camera = inverted_in_single_precision(camera_to_world);
            for (int k = 0; k < 16; ++k) truth.m[k / 4][k % 4] = double(camera_to_world.m[k / 4][k % 4]);
        } else {
            camera_to_world = inverted_in_single_precision(world_to_camera);
            if (i % 3 == 2) {
                Matrix4x4 move = identity, back = identity;
                for (int r = 0; r < 3; ++r) move.m[r][3] = float(random.between(-1e5, 1e5)), back.m[r][3] = -move.m[r][3];
                world_to_camera = product(world_to_camera, move);
                camera_to_world = product(back, camera_to_world);
            }
            truth = inverted(world_to_camera);
        }
        rounded += !is_affine(camera_to_world) || !is_affine(world_to_camera);
        Transform transform{&world_to_camera, &camera_to_world};
        Film *film = new MeanFilm(request.x, request.y);
        Camera *camera = plugin.create(request.params, transform, film);
        if (camera == nullptr) {
            ++refused;
            delete film;
            continue;
        }
        for (int n = 0; n < 3; ++n) {
            Sample sample{float(random.between(0, request.x)), float(random.between(0, request.y)), 0.5f, 0.5f, 0,
                          {}, {}, nullptr, nullptr};
            Ray got = fresh_ray(), plain = fresh_ray();
            camera->GenerateRay(sample, &got);
            reference->GenerateRay(sample, &plain);
            double o[3], d[3], length = 0, apart = 0, moved = 0, away = 1;
            for (int r = 0; r < 3; ++r) {
                const double *m = truth.m[r];
                o[r] = m[0] * double(plain.o.x) + m[1] * double(plain.o.y) + m[2] * double(plain.o.z) + m[3];
                d[r] = m[0] * double(plain.d.x) + m[1] * double(plain.d.y) + m[2] * double(plain.d.z);
                length += d[r] * d[r];
                away = std::fmax(away, std::fabs(o[r]));
            }
            const float got_o[3] = {got.o.x, got.o.y, got.o.z}, got_d[3] = {got.d.x, got.d.y, got.d.z};
            for (int r = 0; r < 3; ++r) {
                apart += std::pow(double(got_d[r]) - d[r] / std::sqrt(length), 2);
                moved += std::pow(double(got_o[r]) - o[r], 2);
            }
            direction_error = std::fmax(direction_error, std::sqrt(apart));
            origin_error = std::fmax(origin_error, std::sqrt(moved) / away);
        }
        delete camera;
    }
    delete reference;
    std::printf("placements %d %d %d %.9g %.9g\n", request.placements, refused, rounded, direction_error, origin_error);
}

void print_matrix(const char *key, const Matrix4x4 &matrix) {
    std::printf("%s", key);
    for (int i = 0; i < 16; ++i) std::printf(" %.9g", double(matrix.m[i / 4][i % 4]));
    std::printf("\n");
}

void refusals(const Plugin &plugin, const Transform &w2c, const Camera *ours) {
    Sample sample{1, 1, 0.5f, 0.5f, 0, {}, {}, nullptr, nullptr};
    Ray ray = fresh_ray();
    ForeignCamera *foreign = new ForeignCamera(w2c, nullptr);
    const void *zeros[4] = {nullptr, nullptr, nullptr, nullptr};
    float sum = plugin.generate(nullptr, &sample, &ray) + plugin.generate(foreign, &sample, &ray) +
                plugin.generate(zeros, &sample, &ray) + plugin.generate(ours, nullptr, &ray) +
                plugin.generate(ours, &sample, nullptr) +
                plugin.generate(reinterpret_cast<const char *>(ours) + 1, &sample, &ray);
    print_ray("refused", sum, ray);
    delete foreign;
    base_calls = 0;
}

void print_layout() {
#define SIZE(type) std::printf("layout " #type " %zu %zu\n", sizeof(type), alignof(type))
#define OFFSET(type, member)                                                                       \
    std::printf("layout " #type "." #member " %zu\n",                                              \
                std::size_t(reinterpret_cast<const char *>(&object->member) - bytes))
#define OBJECT(type)                                                                               \
    SIZE(type);                                                                                    \
    alignas(16) static char space_##type[sizeof(type)];                                            \
    bytes = space_##type;                                                                          \
    if (const type *object = reinterpret_cast<const type *>(bytes))
    const char *bytes;
    OBJECT(Sample) {
        OFFSET(Sample, imageX), OFFSET(Sample, imageY), OFFSET(Sample, lensU), OFFSET(Sample, lensV);
        OFFSET(Sample, time), OFFSET(Sample, n1D), OFFSET(Sample, n2D), OFFSET(Sample, oneD), OFFSET(Sample, twoD);
    }
    OBJECT(Ray) {
        OFFSET(Ray, o), OFFSET(Ray, d), OFFSET(Ray, mint), OFFSET(Ray, maxt), OFFSET(Ray, time);
    }
    OBJECT(RayDifferential) {
        OFFSET(RayDifferential, hasDifferentials), OFFSET(RayDifferential, rx), OFFSET(RayDifferential, ry);
    }
    OBJECT(Matrix4x4) { OFFSET(Matrix4x4, nReferences), OFFSET(Matrix4x4, m); }
    OBJECT(Transform) { OFFSET(Transform, m), OFFSET(Transform, mInv); }
    OBJECT(Film) { OFFSET(Film, xResolution), OFFSET(Film, yResolution); }
    OBJECT(Camera) {
        OFFSET(Camera, film), OFFSET(Camera, WorldToCamera), OFFSET(Camera, CameraToWorld);
        OFFSET(Camera, ClipHither), OFFSET(Camera, ClipYon), OFFSET(Camera, ShutterOpen);
        OFFSET(Camera, ShutterClose);
    }
    OBJECT(ParamSet) {
        OFFSET(ParamSet, ints), OFFSET(ParamSet, bools), OFFSET(ParamSet, floats), OFFSET(ParamSet, strings);
        OFFSET(ParamSet, textures);
    }
    SIZE(std::string);
}

void report_and_clear(ParamSet *params) {
    params->ints.report_and_clear();
    params->bools.report_and_clear();
    params->floats.report_and_clear();
    params->points.report_and_clear();
    params->vectors.report_and_clear();
    params->normals.report_and_clear();
    params->spectra.report_and_clear();
    params->strings.report_and_clear();
    params->textures.report_and_clear();
}

int main(int count, char **arguments) {
    if (count < 3) return 2;
    std::string action = arguments[2];
    if (action == "layout") {
        print_layout();
        return 0;
    }
    void *library = dlopen(arguments[1], RTLD_LAZY);
    if (library == nullptr) {
        std::printf("dlopen %s\n", dlerror());
        return 3;
    }
    Plugin plugin{reinterpret_cast<Create>(dlsym(library, "CreateCamera")),
                  reinterpret_cast<Generate>(dlsym(library, "GenerateRay"))};
    Request request;
    for (int i = 3; i < count; ++i) take(&request, arguments[i]);
    if (action == "placements") {
        placements(plugin, request);
        report_and_clear(&request.params);
        return 0;
    }
    Transform w2c{&request.world_to_camera, &request.camera_to_world};
    Film *film = new MeanFilm(request.x, request.y);
    Camera *camera = plugin.create(request.params, w2c, action == "nofilm" ? nullptr : film);
    Camera *second = nullptr;
    if (action == "two" && camera != nullptr)
        second = plugin.create(request.params, w2c, new MeanFilm(request.x / 2, request.y / 2));
    report_and_clear(&request.params);
    std::printf("camera %s\n", camera != nullptr ? "made" : "null");
    if (camera == nullptr) {
        std::printf("films %d\n", films_destroyed);
        delete film;
        return 0;
    }
    if (action == "rays") rays(camera, plugin, request.samples);
    if (action == "render") render(camera, plugin, request.spp);
    if (action == "refusals") refusals(plugin, w2c, camera);
    if (action == "members") {
        std::printf("film %d\n", camera->film == film);
        print_matrix("w2c", *camera->WorldToCamera.m);
        print_matrix("c2w", *camera->CameraToWorld.m);
        std::printf("crossed %d\n", camera->WorldToCamera.mInv == camera->CameraToWorld.m &&
                                        camera->WorldToCamera.m == camera->CameraToWorld.mInv);
        std::printf("clip %.9g %.9g %.9g %.9g\n", double(camera->ClipHither), double(camera->ClipYon),
                    double(camera->ShutterOpen), double(camera->ShutterClose));
    }
    if (second != nullptr) {
        // The cameras are called in turns; then the first is called again after the second is gone.
        for (const Sample &sample : request.samples) {
            rays(camera, plugin, {sample});
            rays(second, plugin, {sample});
        }
        delete second;
        std::printf("films %d\n", films_destroyed);
        rays(camera, plugin, request.samples);
    }
    delete camera;
    std::printf("films %d\nbase %d\nreferences %d %d\n", films_destroyed, base_calls,
                request.world_to_camera.nReferences, request.camera_to_world.nReferences);
    return 0;
}
