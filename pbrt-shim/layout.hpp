// The host's layouts, as measured on pbrt 1.05 (x86-64, Itanium C++ ABI).
//
// These declarations are independent of the host's: plain structures with the members at the measured
// offsets, without the host's behaviour. The library never links against the host.

#ifndef REALISTIC_SHIM_LAYOUT_HPP
#define REALISTIC_SHIM_LAYOUT_HPP

#include <cstddef>
#include <cstdint>

namespace realistic_shim {

// A 4x4 matrix, row-major for column vectors, preceded by a reference count that is not atomic.
struct HostMatrix {
    int32_t references;
    float m[16];
};
static_assert(sizeof(HostMatrix) == 68 && alignof(HostMatrix) == 4, "host matrix");
static_assert(offsetof(HostMatrix, references) == 0, "host matrix");
static_assert(offsetof(HostMatrix, m) == 4, "host matrix");

// A transform: reference-counted pointers to the matrix and to the inverse of the matrix.
struct HostTransform {
    HostMatrix *matrix;
    HostMatrix *inverse;
};
static_assert(sizeof(HostTransform) == 16 && alignof(HostTransform) == 8, "host transform");
static_assert(offsetof(HostTransform, matrix) == 0, "host transform");
static_assert(offsetof(HostTransform, inverse) == 8, "host transform");

// A film, whose vtable begins with the two destructors.
struct HostFilm {
    const void *const *vtable;
    int32_t x_resolution;
    int32_t y_resolution;
};
static_assert(sizeof(HostFilm) == 16 && alignof(HostFilm) == 8, "host film");
static_assert(offsetof(HostFilm, x_resolution) == 8, "host film");
static_assert(offsetof(HostFilm, y_resolution) == 12, "host film");

// Slot of the deleting destructor (D0) in the film's vtable; slot 0 is the complete destructor (D1).
constexpr std::size_t host_film_slot_delete = 1;

// The members of a host camera after its vtable pointer.
struct HostCameraMembers {
    HostFilm *film;
    HostTransform world_to_camera;
    HostTransform camera_to_world;
    float hither;
    float yon;
    float shutter_open;
    float shutter_close;
};
// The offset of a member in the camera is its offset here plus the 8 bytes of the vtable pointer.
constexpr std::size_t host_camera_vptr_size = 8;
static_assert(sizeof(void *) == host_camera_vptr_size, "64-bit pointers");
static_assert(sizeof(HostCameraMembers) + host_camera_vptr_size == 64, "host camera");
static_assert(alignof(HostCameraMembers) == 8, "host camera");
static_assert(offsetof(HostCameraMembers, film) + host_camera_vptr_size == 8, "host camera");
static_assert(offsetof(HostCameraMembers, world_to_camera) + host_camera_vptr_size == 16, "host camera");
static_assert(offsetof(HostCameraMembers, camera_to_world) + host_camera_vptr_size == 32, "host camera");
static_assert(offsetof(HostCameraMembers, hither) + host_camera_vptr_size == 48, "host camera");
static_assert(offsetof(HostCameraMembers, yon) + host_camera_vptr_size == 52, "host camera");
static_assert(offsetof(HostCameraMembers, shutter_open) + host_camera_vptr_size == 56, "host camera");
static_assert(offsetof(HostCameraMembers, shutter_close) + host_camera_vptr_size == 60, "host camera");

} // namespace realistic_shim

#endif
