/* The interface between the C++ code and the Rust library. Internal: none of these
 * names is exported from the shared library, and none may throw.
 * src/abi/pbrt/shim.rs and src/abi/object/mod.rs declare the same in Rust. */

#ifndef REALISTIC_SHIM_H
#define REALISTIC_SHIM_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Generates one ray for a host: returns the weight and writes the ray. `sample` and `ray` are objects of the
 * host. */
typedef float (*realistic_shim_generate)(const void *rust, const void *sample, void *ray);
/* Destroys the Rust part of a camera. */
typedef void (*realistic_shim_release)(void *rust);

/* The parts of a camera object. */
typedef struct realistic_shim_parts {
    void *rust;
    realistic_shim_generate generate;
    realistic_shim_release release;
    void *film; /* the host's film, from now on the camera's; or NULL */
    float world_to_camera[16];
    float camera_to_world[16];
    float hither;
    float yon;
    float shutter_open;
    float shutter_close;
} realistic_shim_parts;

/* A camera object begins with its vtable pointer, followed by this number of bytes of the host's members and
 * by `rust`. The Rust side recognises its own cameras by the vtable pointer. */
#define REALISTIC_SHIM_HOST_MEMBERS 56

/* Returns a new camera object that a host can use like its own, or NULL if memory is exhausted; in that case
 * the caller still owns `rust` and `film`. */
void *realistic_shim_camera_new(const realistic_shim_parts *parts);
/* Deletes a camera object as a host does, through its vtable. NULL is allowed. */
void realistic_shim_camera_delete(void *camera);
/* Reads the floats of a host's transform: the matrix and the inverse. Returns 0 if a pointer is NULL. */
int32_t realistic_shim_transform(const void *transform, float matrix[16], float inverse[16]);
/* Reads the resolution of a host's film. Returns 0 if `film` is NULL. */
int32_t realistic_shim_film_resolution(const void *film, int32_t *x, int32_t *y);

enum { REALISTIC_SHIM_FLOAT = 0, REALISTIC_SHIM_INT = 1, REALISTIC_SHIM_BOOL = 2, REALISTIC_SHIM_STRING = 3 };
enum {
    REALISTIC_SHIM_ABSENT = 0,  /* the scene does not give it */
    REALISTIC_SHIM_FOUND = 1,
    REALISTIC_SHIM_NO_HOST = 2, /* no such function in this process */
    REALISTIC_SHIM_FAILED = 3   /* an exception: memory is out */
};

/* The values that a scene gives for one name and kind. The pointers are valid as long as the host's parameter
 * set. */
typedef struct realistic_shim_found {
    int32_t count;           /* values given */
    int32_t boolean;         /* the first value, when count > 0 and the kind is bool */
    const float *floats;     /* `count` values, when the kind is float */
    const int32_t *integers; /* `count` values, when the kind is integer */
    const char *text;        /* the first value, when count > 0 and the kind is string */
    size_t text_size;
} realistic_shim_found;

/* Looks up a parameter in the host's set with the host's own function, which also marks the parameter as
 * used. Writes `out` only if the result is REALISTIC_SHIM_FOUND. */
int32_t realistic_shim_find(const void *params, int32_t kind, const char *name, size_t name_size,
                            realistic_shim_found *out);

/* Kinds of texts of the host. */
enum {
    REALISTIC_SHIM_PARAMETERS = 0, /* every parameter of the set as a scene file writes it */
    REALISTIC_SHIM_SCENE_FILE = 1  /* the path of the file that the host is reading */
};
/* Receives a text, which is valid only during the call. */
typedef void (*realistic_shim_take)(void *user, const char *text, size_t size);
/* Passes a text of the host to `take` if the process exports that text. Returns REALISTIC_SHIM_FOUND or the
 * failure. */
int32_t realistic_shim_text(const void *params, int32_t which, realistic_shim_take take, void *user);

/* Prints a message with the host's functions or, if the process has none, on stderr. Level 0: information, 1:
 * warning, 2: error. */
void realistic_shim_message(int32_t level, const char *text);

#ifdef __cplusplus
}
#endif

#endif
