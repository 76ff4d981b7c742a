// The host's functions are looked up at run time, so that the library also loads without them (a Rust library
// binds all symbols when it is loaded).

#include "shim.h"

#include <cstdio>
#include <dlfcn.h>

extern "C" {
int32_t realistic_shim_find_new(const void *, int32_t, const char *, size_t, realistic_shim_found *);
int32_t realistic_shim_find_old(const void *, int32_t, const char *, size_t, realistic_shim_found *);
int32_t realistic_shim_text_new(const void *, int32_t, realistic_shim_take, void *);
int32_t realistic_shim_text_old(const void *, int32_t, realistic_shim_take, void *);
}

extern "C" int32_t realistic_shim_find(const void *params, int32_t kind, const char *name, size_t name_size,
                                       realistic_shim_found *out) {
    int32_t result = realistic_shim_find_new(params, kind, name, name_size, out);
    if (result == REALISTIC_SHIM_NO_HOST) {
        result = realistic_shim_find_old(params, kind, name, name_size, out);
    }
    return result;
}

extern "C" int32_t realistic_shim_text(const void *params, int32_t which, realistic_shim_take take, void *user) {
    int32_t result = realistic_shim_text_new(params, which, take, user);
    if (result == REALISTIC_SHIM_NO_HOST) {
        result = realistic_shim_text_old(params, which, take, user);
    }
    return result;
}

extern "C" void realistic_shim_message(int32_t level, const char *text) {
    // These functions are printf-like. The host's fourth such function, which ends the process, is never
    // called.
    static const char *const symbols[] = {"_Z4InfoPKcz", "_Z7WarningPKcz", "_Z5ErrorPKcz"};
    static const char *const names[] = {"Notice", "Warning", "Error"};
    const int32_t known = level < 0 ? 0 : level > 2 ? 2 : level;
    using Print = void (*)(const char *, ...);
    try {
        if (Print print = reinterpret_cast<Print>(dlsym(RTLD_DEFAULT, symbols[known]))) {
            print("%s", text);
        } else {
            std::fprintf(stderr, "%s: %s\n", names[known], text);
        }
    } catch (...) {
        // If the host's message function throws, the message is lost.
    }
}
