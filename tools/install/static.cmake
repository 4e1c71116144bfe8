# TERACELL_STATIC: what is linked takes archives of the libraries with it, and runs wherever the C library is not older than here. What is
# compiled stays the same.
add_link_options(-static-libstdc++ -static-libgcc -Wl,--exclude-libs,ALL)

# TARGET becomes the archive of NAME, which needs others.
function(teracell_archive target name)
  find_library(TERACELL_ARCHIVE_${name} lib${name}.a REQUIRED)
  get_target_property(type ${target} TYPE)
  if(type STREQUAL INTERFACE_LIBRARY)  # as pkg-config's are
    add_library(teracell_archive_${name} STATIC IMPORTED)
    set_target_properties(${target} PROPERTIES INTERFACE_LINK_LIBRARIES teracell_archive_${name})
    set(target teracell_archive_${name})
  endif()
  set_target_properties(${target} PROPERTIES IMPORTED_LOCATION ${TERACELL_ARCHIVE_${name}} IMPORTED_LOCATION_RELEASE ${TERACELL_ARCHIVE_${name}}
    INTERFACE_LINK_LIBRARIES "${ARGN}")
endfunction()
teracell_archive(ZLIB::ZLIB z)
teracell_archive(PkgConfig::ZSTD zstd)
teracell_archive(PkgConfig::XXHASH xxhash)
teracell_archive(PkgConfig::MINIZIP minizip ZLIB::ZLIB)

# Archives are compiled for programs, and a shared library can't have what they say of the C library's variables. Expat's, on Debian 13 and
# Ubuntu 24.04, name stderr: here that becomes a variable of our own.
find_library(TERACELL_ARCHIVE_expat libexpat.a REQUIRED)
set(expat ${CMAKE_CURRENT_BINARY_DIR}/libexpat.a)
execute_process(COMMAND ${CMAKE_OBJCOPY} --redefine-sym stderr=teracell_stderr ${TERACELL_ARCHIVE_expat} ${expat} COMMAND_ERROR_IS_FATAL ANY)
file(CONFIGURE OUTPUT stderr.cpp CONTENT "#include <cstdio>\nextern \"C\" { FILE* teracell_stderr = stderr; }\n")
add_library(teracell_stderr STATIC ${CMAKE_CURRENT_BINARY_DIR}/stderr.cpp)
set_target_properties(teracell_stderr PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden)
set_target_properties(EXPAT::EXPAT PROPERTIES IMPORTED_LOCATION ${expat} IMPORTED_LOCATION_RELEASE ${expat} INTERFACE_LINK_LIBRARIES teracell_stderr)

# Debian has no archive of {fmt}, whose headers are also its sources. Who uses it is compiled as with the shared library.
file(CONFIGURE OUTPUT fmt.cpp CONTENT "#define FMT_HEADER_ONLY\n#include <fmt/format.h>\n")
add_library(fmt STATIC ${CMAKE_CURRENT_BINARY_DIR}/fmt.cpp)
set_target_properties(fmt PROPERTIES POSITION_INDEPENDENT_CODE ON COMPILE_OPTIONS -fkeep-inline-functions)
target_compile_definitions(fmt INTERFACE FMT_SHARED)
add_library(fmt::fmt ALIAS fmt)
