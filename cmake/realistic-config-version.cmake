# A test compares it with Cargo.toml's. Of versions 0.x one minor number is not compatible with another.
set(PACKAGE_VERSION 0.1.0)
string(REGEX MATCH "^0\\.[0-9]+" series "${PACKAGE_VERSION}")
if(PACKAGE_FIND_VERSION VERSION_LESS_EQUAL PACKAGE_VERSION AND PACKAGE_FIND_VERSION MATCHES "^${series}(\\.|$)")
    set(PACKAGE_VERSION_COMPATIBLE TRUE)
    if(PACKAGE_FIND_VERSION VERSION_EQUAL PACKAGE_VERSION)
        set(PACKAGE_VERSION_EXACT TRUE)
    endif()
endif()
