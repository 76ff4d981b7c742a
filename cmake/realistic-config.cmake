# find_package(realistic): the target realistic::realistic. This lies in share/cmake/realistic of a release archive or of what
# `cargo cinstall` installs, wherever that was put.
get_filename_component(realistic_PREFIX "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
set(realistic_LIBRARY "realistic_LIBRARY-NOTFOUND")
# cargo-c's place is Debian's, of its kind of machine.
foreach(folder IN ITEMS lib lib64 "lib/${CMAKE_LIBRARY_ARCHITECTURE}")
    set(file "${realistic_PREFIX}/${folder}/${CMAKE_SHARED_LIBRARY_PREFIX}realistic${CMAKE_SHARED_LIBRARY_SUFFIX}")
    if(EXISTS "${file}")
        set(realistic_LIBRARY "${file}")
    endif()
endforeach()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(realistic REQUIRED_VARS realistic_LIBRARY VERSION_VAR realistic_VERSION)
if(realistic_FOUND AND NOT TARGET realistic::realistic)
    add_library(realistic::realistic SHARED IMPORTED)
    # The archive's library, which is pbrt's plugin, too, has no SONAME.
    set_target_properties(realistic::realistic PROPERTIES
        IMPORTED_LOCATION "${realistic_LIBRARY}"
        IMPORTED_NO_SONAME TRUE
        INTERFACE_INCLUDE_DIRECTORIES "${realistic_PREFIX}/include")
endif()
