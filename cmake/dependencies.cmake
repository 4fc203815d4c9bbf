# The packages that each part needs; a part that is not built needs none.

# The compiler.
find_package(nlohmann_json REQUIRED)
find_package(fmt REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)
# glslang's package file refers to SPIRV-Tools and Threads without finding them.
find_package(Threads REQUIRED)
find_package(SPIRV-Tools REQUIRED)
find_package(SPIRV-Tools-opt REQUIRED)
find_package(glslang REQUIRED)

if(ISOSHADE_RUNTIME)
  find_package(glm REQUIRED)
  find_package(TBB REQUIRED)
  find_package(OpenEXR 3.1 REQUIRED)
  find_package(ZLIB REQUIRED)
  find_path(TINYGLTF_INCLUDE_DIR tiny_gltf.h REQUIRED)
  find_package(PkgConfig REQUIRED)
  pkg_check_modules(spng REQUIRED IMPORTED_TARGET spng)
  pkg_check_modules(jpeg REQUIRED IMPORTED_TARGET libjpeg)
  pkg_check_modules(mpfr REQUIRED IMPORTED_TARGET mpfr gmp)
endif()
if(ISOSHADE_VULKAN)
  find_package(Vulkan REQUIRED)
endif()
if(ISOSHADE_COMMAND)
  find_package(CLI11 REQUIRED)
endif()
