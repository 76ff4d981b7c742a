// The look-up of parameters and of the host's texts. This file is included twice, by find_new.cpp and
// find_old.cpp, which select the std::string ABI before any standard header and name the functions: a host of
// either ABI is then served by functions that use the same std::string as the host.

#include "shim.h"

#include <dlfcn.h>
#include <string>

#define REALISTIC_PASTE2(a, b) a##b
#define REALISTIC_PASTE(a, b) REALISTIC_PASTE2(a, b)

namespace {

// Mangled names, in the Itanium C++ ABI, of const member functions of the host's parameter set. These
// functions take the name by reference and return the number of values through a pointer.
constexpr const char *float_symbol = "_ZNK8ParamSet9FindFloatERK" REALISTIC_STRING_MANGLED "Pi";
constexpr const char *int_symbol = "_ZNK8ParamSet7FindIntERK" REALISTIC_STRING_MANGLED "Pi";
constexpr const char *bool_symbol = "_ZNK8ParamSet8FindBoolERK" REALISTIC_STRING_MANGLED "Pi";
constexpr const char *string_symbol = "_ZNK8ParamSet10FindStringERK" REALISTIC_STRING_MANGLED "Pi";

// Mangled names of a function that returns the set as text, and of a variable. An ABI tag in each name states
// which std::string is used.
constexpr const char *text_symbol = "_ZNK8ParamSet8ToString" REALISTIC_STRING_TAG "Ev";
constexpr const char *file_symbol = REALISTIC_SCENE_FILE;

// A member function, which receives its object as the first argument; NULL if the process has no such
// function.
template <class T> using Finder = const T *(*)(const void *, const std::string &, int *);

template <class T> Finder<T> finder(const char *symbol) {
    return reinterpret_cast<Finder<T>>(dlsym(RTLD_DEFAULT, symbol));
}

} // namespace

extern "C" int32_t REALISTIC_PASTE(realistic_shim_find_, REALISTIC_STRING_SUFFIX)(const void *params, int32_t kind,
                                                                              const char *name, size_t name_size,
                                                                              realistic_shim_found *out) {
#if _GLIBCXX_USE_CXX11_ABI == REALISTIC_STRING_NEW
    static_assert(sizeof(std::string) == (REALISTIC_STRING_NEW ? 32 : 8), "the std::string ABI asked for");
    try {
        const std::string key(name, name_size);
        realistic_shim_found found = realistic_shim_found();
        int count = 0;
        bool given = false;
        switch (kind) {
        case REALISTIC_SHIM_FLOAT:
            if (Finder<float> find = finder<float>(float_symbol)) {
                found.floats = find(params, key, &count);
                given = found.floats != nullptr;
                break;
            }
            return REALISTIC_SHIM_NO_HOST;
        case REALISTIC_SHIM_INT:
            if (Finder<int> find = finder<int>(int_symbol)) {
                found.integers = find(params, key, &count);
                given = found.integers != nullptr;
                break;
            }
            return REALISTIC_SHIM_NO_HOST;
        case REALISTIC_SHIM_BOOL:
            if (Finder<bool> find = finder<bool>(bool_symbol)) {
                const bool *values = find(params, key, &count);
                given = values != nullptr;
                found.boolean = given && count > 0 && values[0];
                break;
            }
            return REALISTIC_SHIM_NO_HOST;
        case REALISTIC_SHIM_STRING:
            if (Finder<std::string> find = finder<std::string>(string_symbol)) {
                const std::string *values = find(params, key, &count);
                given = values != nullptr;
                if (given && count > 0) {
                    found.text = values[0].data();
                    found.text_size = values[0].size();
                }
                break;
            }
            return REALISTIC_SHIM_NO_HOST;
        default:
            return REALISTIC_SHIM_ABSENT;
        }
        if (!given) {
            return REALISTIC_SHIM_ABSENT;
        }
        found.count = count;
        *out = found;
        return REALISTIC_SHIM_FOUND;
    } catch (...) {
        return REALISTIC_SHIM_FAILED;
    }
#else
    // This C++ library has only one std::string ABI, and that is not the one of this file.
    (void)params, (void)kind, (void)name, (void)name_size, (void)out;
    (void)float_symbol, (void)int_symbol, (void)bool_symbol, (void)string_symbol;
    return REALISTIC_SHIM_NO_HOST;
#endif
}

extern "C" int32_t REALISTIC_PASTE(realistic_shim_text_, REALISTIC_STRING_SUFFIX)(const void *params, int32_t which,
                                                                              realistic_shim_take take, void *user) {
#if _GLIBCXX_USE_CXX11_ABI == REALISTIC_STRING_NEW
    // In a process without such a host, a variable with that name may be anything.
    if (!finder<float>(float_symbol)) {
        return REALISTIC_SHIM_NO_HOST;
    }
    try {
        if (which == REALISTIC_SHIM_SCENE_FILE) {
            if (const std::string *file = static_cast<const std::string *>(dlsym(RTLD_DEFAULT, file_symbol))) {
                take(user, file->data(), file->size());
                return REALISTIC_SHIM_FOUND;
            }
        } else if (void *symbol = dlsym(RTLD_DEFAULT, text_symbol)) {
            const std::string text = reinterpret_cast<std::string (*)(const void *)>(symbol)(params);
            take(user, text.data(), text.size());
            return REALISTIC_SHIM_FOUND;
        }
        return REALISTIC_SHIM_ABSENT;
    } catch (...) {
        return REALISTIC_SHIM_FAILED;
    }
#else
    (void)params, (void)which, (void)take, (void)user, (void)text_symbol, (void)file_symbol;
    return REALISTIC_SHIM_NO_HOST;
#endif
}
