// The look-up of parameters for a host built with the reference-counted std::string of before 2015.
#undef _GLIBCXX_USE_CXX11_ABI
#define _GLIBCXX_USE_CXX11_ABI 0
#define REALISTIC_STRING_NEW 0
#define REALISTIC_STRING_SUFFIX old
#define REALISTIC_STRING_MANGLED "Ss"
#define REALISTIC_STRING_TAG ""
#define REALISTIC_SCENE_FILE "current_file"
#include "find.hpp"
