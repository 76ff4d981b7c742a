// The implementation of LensCamera: pbrt-v4's samples, rays and importance by the C ABI (include/realistic.h). README.md
// states how to add it to pbrt-v4. MIT OR Apache-2.0.
//
// The lens's camera space is pbrt's camera space: +z forward, +x right, +y up. pbrt's own transform maps the rays from
// camera space to the scene, and so handles a moving camera. The lens's shutter times are 0 to 1, as fractions of
// pbrt's interval.

#include <pbrt/cameras.h>

#include <pbrt/interaction.h>
#include <pbrt/paramdict.h>
#include <pbrt/util/error.h>
#include <pbrt/util/file.h>
#include <pbrt/util/print.h>

#include <realistic.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pbrt {

namespace {

// The parameters that a scene can set, by their names in all hosts (README.md, "Parameters").
struct Number {
    const char *name;
    double realistic_options::*member;
};
const Number numbers[] = {
    {"film_distance", &realistic_options::film_distance},   {"focus_distance", &realistic_options::focus_distance},
    {"fnumber", &realistic_options::fnumber},             {"aperture_diameter", &realistic_options::aperture_diameter},
    {"blades", &realistic_options::blades},               {"blade_rotation", &realistic_options::blade_rotation},
    {"blade_curvature", &realistic_options::blade_curvature}, {"wavelength", &realistic_options::wavelength},
    {"hither", &realistic_options::hither},               {"yon", &realistic_options::yon},
    {"tolerance", &realistic_options::tolerance},         {"shutter_ramp", &realistic_options::shutter_ramp},
    {"shutter_slit", &realistic_options::shutter_slit},
};

struct Text {
    const char *name;
    const char *realistic_options::*member;
    // Whether the text may name a file in the scene's directory.
    bool file;
};
const Text texts[] = {
    {"lens_file", &realistic_options::lens_file, true},   {"glass_catalog", &realistic_options::glass_catalog, true},
    {"focus_by", &realistic_options::focus_by, false},    {"zoom", &realistic_options::zoom, false},
    {"weighting", &realistic_options::weighting, false}, {"pupil", &realistic_options::pupil, false},
    {"precision", &realistic_options::precision, false}, {"shutter", &realistic_options::shutter, false},
    {"model", &realistic_options::model, false},
};

// Returns the view of one number that a call writes.
realistic_output NumberAt(float *number) {
    return {number, nullptr, nullptr, 0};
}

void Tell(void *loc, int32_t level, const char *message) {
    if (level > 0)
        Warning(static_cast<const FileLoc *>(loc), "%s", message);
}

// Returns a request for a ray at one wavelength, or at the camera's own wavelength if the pointer is NULL.
realistic_request RequestFor(const float *wavelength) {
    realistic_request request = {};
    request.struct_size = sizeof request;
    if (wavelength != nullptr)
        request.wavelength.x = wavelength;
    return request;
}

// Returns whether rays at the ends of the spectrum take different paths.
bool Disperses(const realistic_camera *camera, Point2i resolution) {
    for (float at : {0.5f, 0.7f, 0.9f}) {
        const realistic_sample sample = {at * resolution.x, at * resolution.y, at, 0.4f, 0};
        realistic_ray rays[2] = {};
        for (int end : {0, 1}) {
            const float wavelength = end == 0 ? 380.f : 780.f;
            const realistic_request request = RequestFor(&wavelength);
            realistic_generate_ray(camera, &sample, &request, &rays[end]);
        }
        if (!std::equal(rays[0].d, rays[0].d + 3, rays[1].d))
            return true;
    }
    return false;
}

Point3f PointOf(const float *p) { return Point3f(p[0], p[1], p[2]); }
Vector3f VectorOf(const float *v) { return Vector3f(v[0], v[1], v[2]); }

}  // namespace

struct LensCamera::Lens {
    realistic_camera *camera;
    // Whether each wavelength takes its own path, and the scene does not fix one wavelength for all rays.
    bool disperses;
    // Distance along a ray at which the ray begins.
    Float hither;
    std::string name;

    // Importance and densities of a ray that enters the camera at a point of camera space.
    struct Counted {
        float x = 0, y = 0, importance = 0, area = 0, solidAngle = 0;
    };
    Counted Count(Point3f p, Vector3f toCamera, float time) const {
        Counted found;
        const float o[] = {float(p.x), float(p.y), float(p.z)};
        const float d[] = {float(toCamera.x), float(toCamera.y), float(toCamera.z)};
        const realistic_importance_rays rays = {
            sizeof rays, {&o[0], &o[1], &o[2], 0}, {&d[0], &d[1], &d[2], 0}, {&time, nullptr, nullptr, 0}};
        const realistic_importance counts = {sizeof counts,
                                             {&found.x, &found.y, nullptr, 0},
                                             NumberAt(&found.importance),
                                             {},
                                             NumberAt(&found.area),
                                             NumberAt(&found.solidAngle)};
        realistic_camera_importance(camera, 1, &rays, &counts);
        return found;
    }
};

LensCamera::LensCamera(CameraBaseParameters base, const Lens *lens) : CameraBase(base), lens(lens) {
    FindMinimumDifferentials(this);
}

LensCamera *LensCamera::Create(const ParameterDictionary &parameters, const CameraTransform &cameraTransform, Film film,
                               Medium medium, const FileLoc *loc, Allocator alloc) {
    CameraBaseParameters base(cameraTransform, film, medium, parameters, loc);
    realistic_options options;
    realistic_options_init(&options, sizeof options);
    options.xres = film.FullResolution().x;
    options.yres = film.FullResolution().y;
    // pbrt keeps the film's diagonal in metres, and converts lenses from millimetres to metres.
    options.film_diagonal = 1000 * film.Diagonal();
    options.mm_per_unit = parameters.GetOneFloat("mm_per_unit", 1000);
    options.log = Tell;
    options.log_user = const_cast<FileLoc *>(loc);
    for (const Number &number : numbers)
        options.*number.member = parameters.GetOneFloat(number.name, std::numeric_limits<Float>::quiet_NaN());
    std::string given[std::size(texts)];
    for (size_t i = 0; i < std::size(texts); ++i) {
        given[i] = parameters.GetOneString(texts[i].name, texts[i].member == &realistic_options::weighting ? "relative" : "");
        if (texts[i].file && FileExists(ResolveFilename(given[i])))
            given[i] = ResolveFilename(given[i]);
        if (!given[i].empty())
            options.*texts[i].member = given[i].c_str();
    }

    realistic_camera *camera = nullptr;
    if (realistic_camera_new(&options, &camera) != REALISTIC_STATUS_OK)
        ErrorExit(loc, "%s", realistic_last_error());
    char name[256] = "";
    realistic_camera_get_lens_name(camera, name, sizeof name, nullptr);
    const bool disperses = std::isnan(options.wavelength) && Disperses(camera, film.FullResolution());
    const Float hither = std::isnan(options.hither) ? 1e-3f : Float(options.hither);
    // The camera lives as long as pbrt's scene, which is as long as the process.
    return alloc.new_object<LensCamera>(base, new Lens{camera, disperses, hither, name});
}

pstd::optional<CameraRay> LensCamera::GenerateRay(CameraSample sample, SampledWavelengths &lambda) const {
    pstd::optional<CameraRayDifferential> found = GenerateRayDifferential(sample, lambda);
    if (!found)
        return {};
    return CameraRay{Ray(found->ray), found->weight};
}

pstd::optional<CameraRayDifferential> LensCamera::GenerateRayDifferential(CameraSample sample,
                                                                          SampledWavelengths &lambda) const {
    const realistic_sample at = {float(sample.pFilm.x), float(sample.pFilm.y), float(sample.pLens.x),
                                 float(sample.pLens.y), float(sample.time)};
    // pbrt's wavelengths extend a little beyond the visible range.
    const float wavelength = Clamp(lambda[0], 380, 780);
    const realistic_request request = RequestFor(lens->disperses ? &wavelength : nullptr);
    realistic_ray_differential found = {};
    found.struct_size = sizeof found;
    const float weight = realistic_generate_ray_differential(lens->camera, &at, &request, &found);
    if (weight == 0)
        return {};
    // The other wavelengths would take other paths.
    if (lens->disperses)
        lambda.TerminateSecondary();
    const Vector3f d = VectorOf(found.ray.d);
    RayDifferential ray(PointOf(found.ray.o) + lens->hither * d, d, SampleTime(sample.time), medium);
    ray.rxOrigin = PointOf(found.rx_o) + lens->hither * VectorOf(found.rx_d);
    ray.ryOrigin = PointOf(found.ry_o) + lens->hither * VectorOf(found.ry_d);
    ray.rxDirection = VectorOf(found.rx_d);
    ray.ryDirection = VectorOf(found.ry_d);
    ray.hasDifferentials = found.has == (REALISTIC_HAS_RX | REALISTIC_HAS_RY);
    return CameraRayDifferential{RenderFromCamera(ray), SampledSpectrum(weight)};
}

SampledSpectrum LensCamera::We(const Ray &ray, SampledWavelengths &lambda, Point2f *pRasterOut) const {
    const float time = shutterClose > shutterOpen ? (ray.time - shutterOpen) / (shutterClose - shutterOpen) : 0;
    const Lens::Counted found =
        lens->Count(CameraFromRender(ray.o, ray.time), -CameraFromRender(ray.d, ray.time), time);
    if (pRasterOut)
        *pRasterOut = Point2f(found.x, found.y);
    return SampledSpectrum(found.importance);
}

void LensCamera::PDF_We(const Ray &ray, Float *pdfPos, Float *pdfDir) const {
    const float time = shutterClose > shutterOpen ? (ray.time - shutterOpen) / (shutterClose - shutterOpen) : 0;
    const Lens::Counted found =
        lens->Count(CameraFromRender(ray.o, ray.time), -CameraFromRender(ray.d, ray.time), time);
    *pdfPos = found.area;
    *pdfDir = found.solidAngle;
}

pstd::optional<CameraWiSample> LensCamera::SampleWi(const Interaction &ref, Point2f u, SampledWavelengths &lambda) const {
    const Point3f p = CameraFromRender(ref.p(), ref.time);
    const float given[] = {float(p.x), float(p.y), float(p.z), float(u.x), float(u.y)};
    const float time = shutterClose > shutterOpen ? (ref.time - shutterOpen) / (shutterClose - shutterOpen) : 0;
    const realistic_scene_points points = {sizeof points,
                                           {&given[0], &given[1], &given[2], 0},
                                           {&given[3], &given[4], nullptr, 0},
                                           {&time, nullptr, nullptr, 0}};
    float o[3] = {}, d[3] = {}, density = 0, x = 0, y = 0, importance = 0;
    const realistic_aimed aimed = {
        sizeof aimed, {&o[0], &o[1], &o[2], 0}, {&d[0], &d[1], &d[2], 0}, NumberAt(&density)};
    const realistic_importance counts = {sizeof counts, {&x, &y, nullptr, 0}, NumberAt(&importance), {}, {}, {}};
    realistic_camera_sample_importance(lens->camera, 1, &points, &aimed, &counts);
    if (density == 0 || importance == 0)
        return {};
    // Objects nearer to the lens than the start of the rays hide nothing.
    const Vector3f toLens = VectorOf(d);
    const Point3f front = RenderFromCamera(PointOf(o) - lens->hither * toLens, ref.time);
    const Normal3f n = RenderFromCamera(Normal3f(0, 0, 1), ref.time);
    const Vector3f wi = Normalize(RenderFromCamera(toLens, ref.time));
    return CameraWiSample(SampledSpectrum(importance), wi, density, Point2f(x, y), ref,
                          Interaction(front, n, ref.time, medium));
}

std::string LensCamera::ToString() const {
    return StringPrintf("[ LensCamera %s lens: %s ]", CameraBase::ToString(), lens->name);
}

}  // namespace pbrt
