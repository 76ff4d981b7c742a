// A camera object that a pbrt-v1 host can call and delete as its own.
//
// This class does not use the host's base class: it calls neither the base class's constructor nor its
// destructor. So the matrices here are copies that share no reference count with the host's matrices, and
// this class deletes the film, which the host's base class would otherwise delete.

#include "layout.hpp"
#include "shim.h"

#include <cstdlib>
#include <cstring>
#include <new>

namespace {

using namespace realistic_shim;

// The object consists of the vtable pointer, the host's members, and then our members. The vtable's slots are
// in the order of the declarations: first the function that generates a ray, then the two destructors.
class Camera {
public:
    explicit Camera(const realistic_shim_parts &parts) noexcept
        : host(), rust(parts.rust), generate(parts.generate), release(parts.release), world_to_camera(),
          camera_to_world() {
        // Each matrix is referenced by two transforms. Its reference count never reaches zero, because the
        // matrices live as long as this object.
        world_to_camera.references = 2;
        camera_to_world.references = 2;
        std::memcpy(world_to_camera.m, parts.world_to_camera, sizeof world_to_camera.m);
        std::memcpy(camera_to_world.m, parts.camera_to_world, sizeof camera_to_world.m);
        host.film = static_cast<HostFilm *>(parts.film);
        host.world_to_camera = HostTransform{&world_to_camera, &camera_to_world};
        host.camera_to_world = HostTransform{&camera_to_world, &world_to_camera};
        host.hither = parts.hither;
        host.yon = parts.yon;
        host.shutter_open = parts.shutter_open;
        host.shutter_close = parts.shutter_close;
    }

    virtual float GenerateRay(const void *sample, void *ray) const { return generate(rust, sample, ray); }

    virtual ~Camera() {
        release(rust);
        if (host.film != nullptr) {
            using Delete = void (*)(void *);
            reinterpret_cast<Delete>(const_cast<void *>(host.film->vtable[host_film_slot_delete]))(host.film);
        }
    }

    Camera(const Camera &) = delete;
    Camera &operator=(const Camera &) = delete;

    // The deleting destructor calls this delete. These operators are independent of the host's global ones,
    // and they do not throw if memory is exhausted.
    static void *operator new(std::size_t size, const std::nothrow_t &) noexcept { return std::malloc(size); }
    static void operator delete(void *memory) noexcept { std::free(memory); }
    static void operator delete(void *memory, const std::nothrow_t &) noexcept { std::free(memory); }

private:
    HostCameraMembers host;
    void *rust;
    realistic_shim_generate generate;
    realistic_shim_release release;
    HostMatrix world_to_camera;
    HostMatrix camera_to_world;
};
static_assert(sizeof(Camera) == host_camera_vptr_size + sizeof(HostCameraMembers) + 3 * sizeof(void *) +
                                    2 * sizeof(HostMatrix),
              "the host's members follow the vtable pointer, and `rust` follows them");
static_assert(sizeof(HostCameraMembers) == REALISTIC_SHIM_HOST_MEMBERS, "as the Rust side has it");

} // namespace

extern "C" void *realistic_shim_camera_new(const realistic_shim_parts *parts) {
    return new (std::nothrow) Camera(*parts);
}

extern "C" void realistic_shim_camera_delete(void *camera) { delete static_cast<Camera *>(camera); }

extern "C" int32_t realistic_shim_transform(const void *transform, float matrix[16], float inverse[16]) {
    const HostTransform *host = static_cast<const HostTransform *>(transform);
    if (host == nullptr || host->matrix == nullptr || host->inverse == nullptr) {
        return 0;
    }
    std::memcpy(matrix, host->matrix->m, sizeof host->matrix->m);
    std::memcpy(inverse, host->inverse->m, sizeof host->inverse->m);
    return 1;
}

extern "C" int32_t realistic_shim_film_resolution(const void *film, int32_t *x, int32_t *y) {
    const HostFilm *host = static_cast<const HostFilm *>(film);
    if (host == nullptr) {
        return 0;
    }
    *x = host->x_resolution;
    *y = host->y_resolution;
    return 1;
}
