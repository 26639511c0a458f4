# One CMake target per layer of the house. The listing is the architecture: a layer's sources are what stands in its
# folder, so folders are globbed (CONFIGURE_DEPENDS re-globs at every build) instead of being listed a second time.

set(RAYWISE_WARNINGS
    -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wnon-virtual-dtor -Wold-style-cast
    -Wdouble-promotion)

# raywise_options(<target>): the language, warning and floating-point rules of everything that is ours.
function(raywise_options target)
    target_compile_features(${target} PUBLIC cxx_std_20)
    set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
    # Contracting a*b+c would make the bytes of a tree depend on the compiler and the instruction set.
    target_compile_options(${target} PRIVATE -ffp-contract=off)
    # g++ 12's superword vectorizer drops the rounding of double -> float -> double when it packs two of them.
    if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
        target_compile_options(${target} PRIVATE -fno-tree-slp-vectorize)
    endif()
    if(PROJECT_IS_TOP_LEVEL)
        target_compile_options(${target} PRIVATE ${RAYWISE_WARNINGS})
        if(RAYWISE_WERROR)
            target_compile_options(${target} PRIVATE -Werror)
        endif()
    endif()
endfunction()

# raywise_layer(<name> [USES layer...] [PRIVATE library...])
function(raywise_layer name)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "USES;PRIVATE")
    set(target raywise_${name})
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${name}/*.cpp)
    file(GLOB headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/include/raywise/${name}/*.hpp)
    add_library(${target} STATIC ${sources})
    add_library(raywise::${name} ALIAS ${target})
    raywise_options(${target})
    target_sources(${target} PUBLIC FILE_SET HEADERS
        BASE_DIRS ${PROJECT_SOURCE_DIR}/include FILES ${headers})
    target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/src)
    set_target_properties(${target} PROPERTIES
        EXPORT_NAME ${name} VERIFY_INTERFACE_HEADER_SETS ${PROJECT_IS_TOP_LEVEL})
    list(TRANSFORM arg_USES PREPEND raywise_)
    target_link_libraries(${target} PUBLIC ${arg_USES} Threads::Threads PRIVATE ${arg_PRIVATE})
    set_property(GLOBAL APPEND PROPERTY RAYWISE_LAYERS ${target})
endfunction()

# raywise_umbrella(): raywise::raywise is all layers and the header <raywise/raywise.hpp>.
function(raywise_umbrella)
    get_property(layers GLOBAL PROPERTY RAYWISE_LAYERS)
    add_library(raywise INTERFACE)
    add_library(raywise::raywise ALIAS raywise)
    target_sources(raywise INTERFACE FILE_SET HEADERS
        BASE_DIRS ${PROJECT_SOURCE_DIR}/include FILES ${PROJECT_SOURCE_DIR}/include/raywise/raywise.hpp)
    target_link_libraries(raywise INTERFACE ${layers})
endfunction()
