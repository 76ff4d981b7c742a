// A camera of pbrt-v4 whose rays pass every surface of a real lens; scenes name it `Camera "lens"`. README.md states
// how to add it to pbrt-v4. Include pbrt/cameras.h, which includes this file after its own cameras. MIT OR Apache-2.0.

#ifndef REALISTIC_LENS_CAMERA_H
#define REALISTIC_LENS_CAMERA_H

#include <string>

namespace pbrt {

// All code specific to the lens is in lens_camera.cpp, so that changes to it do not recompile pbrt's files.
class LensCamera : public CameraBase {
  public:
    struct Lens;

    LensCamera(CameraBaseParameters base, const Lens *lens);

    static LensCamera *Create(const ParameterDictionary &parameters, const CameraTransform &cameraTransform, Film film,
                              Medium medium, const FileLoc *loc, Allocator alloc = {});

    PBRT_CPU_GPU
    pstd::optional<CameraRay> GenerateRay(CameraSample sample, SampledWavelengths &lambda) const;

    PBRT_CPU_GPU
    pstd::optional<CameraRayDifferential> GenerateRayDifferential(CameraSample sample, SampledWavelengths &lambda) const;

    PBRT_CPU_GPU
    SampledSpectrum We(const Ray &ray, SampledWavelengths &lambda, Point2f *pRasterOut = nullptr) const;

    PBRT_CPU_GPU
    void PDF_We(const Ray &ray, Float *pdfPos, Float *pdfDir) const;

    PBRT_CPU_GPU
    pstd::optional<CameraWiSample> SampleWi(const Interaction &ref, Point2f u, SampledWavelengths &lambda) const;

    std::string ToString() const;

  private:
    const Lens *lens;
};

}  // namespace pbrt

#endif  // REALISTIC_LENS_CAMERA_H
