// The look-up of parameters for a host built with the std::string ABI of 2015 and later.
#undef _GLIBCXX_USE_CXX11_ABI
#define _GLIBCXX_USE_CXX11_ABI 1
#define REALISTIC_STRING_NEW 1
#define REALISTIC_STRING_SUFFIX new
#define REALISTIC_STRING_MANGLED "NSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE"
#define REALISTIC_STRING_TAG "B5cxx11"
#define REALISTIC_SCENE_FILE "_Z12current_fileB5cxx11"
#include "find.hpp"
