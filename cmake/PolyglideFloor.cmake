# The house, from the ground up. A floor may use only floors named before it.
set(POLYGLIDE_FLOORS catalog kinematics synthesis optimizer report)
set_property(GLOBAL PROPERTY GLOBAL_DEPENDS_NO_CYCLES ON)

# polyglide_precompile(<target> <kind>)
#
# Lets a target start from the big third-party headers instead of reading them again for every
# file. Flags and code model must be those of the header, so there is one for each kind of
# target: `library`, `interval` (-frounding-math) and `test`.
function(polyglide_precompile target kind)
  if(NOT POLYGLIDE_PCH)
    return()
  endif()
  set(headers_library <tbb/parallel_for.h>)
  set(headers_interval <boost/numeric/interval.hpp>)
  set(flags_interval -frounding-math)
  set(headers_test <gtest/gtest.h>)
  set(links_test GTest::gtest)
  set(owner polyglide_precompiled_${kind})
  if(NOT TARGET ${owner})
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/${owner}.cpp CONTENT "")
    add_library(${owner} OBJECT ${PROJECT_BINARY_DIR}/${owner}.cpp)
    target_link_libraries(${owner} PRIVATE Eigen3::Eigen nlohmann_json::nlohmann_json polyglide_options
                                           ${links_${kind}})
    target_precompile_headers(${owner} PRIVATE ${PROJECT_SOURCE_DIR}/cmake/eigen_instances.hpp <map>
                                               <nlohmann/json.hpp> <string> <vector> ${headers_${kind}})
    target_compile_options(${owner} PRIVATE ${flags_${kind}})
    get_target_property(relocatable ${target} POSITION_INDEPENDENT_CODE)
    set_target_properties(${owner} PROPERTIES POSITION_INDEPENDENT_CODE ${relocatable})
  endif()
  target_precompile_headers(${target} REUSE_FROM ${owner})
endfunction()

# polyglide_add_floor(<name> [USES floor...] [PUBLIC target...] [PRIVATE target...] [INTERVALS source...])
#
# Defines polyglide::<name> from every .cpp beside its headers. Headers are
# included as "<name>/header.hpp". An upward link stops configuration here; an
# upward include is refused by tests/house_test.cpp. INTERVALS prove things by interval
# arithmetic: the compiler must not fold or reorder what depends on the rounding direction.
function(polyglide_add_floor name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "USES;PUBLIC;PRIVATE;INTERVALS")
  list(FIND POLYGLIDE_FLOORS ${name} floor)
  if(floor EQUAL -1)
    message(FATAL_ERROR "polyglide: '${name}' is not in POLYGLIDE_FLOORS (${POLYGLIDE_FLOORS})")
  endif()
  foreach(used IN LISTS arg_USES)
    list(FIND POLYGLIDE_FLOORS ${used} used_floor)
    if(used_floor EQUAL -1 OR used_floor GREATER_EQUAL floor)
      message(FATAL_ERROR "polyglide: ${name} may not use ${used}; the order is ${POLYGLIDE_FLOORS}")
    endif()
  endforeach()

  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${name}/*.cpp
                                    ${PROJECT_SOURCE_DIR}/${name}/README.md)
  file(GLOB headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${name}/*.hpp)
  list(TRANSFORM arg_INTERVALS REPLACE "(.+)" "${PROJECT_SOURCE_DIR}/${name}/\\1.cpp")
  list(TRANSFORM arg_USES PREPEND polyglide::)
  if(arg_INTERVALS)
    # Compiled as a target of their own, which may have a precompiled header; part of the same archive.
    list(REMOVE_ITEM sources ${arg_INTERVALS})
    set(intervals polyglide_${name}_intervals)
    add_library(${intervals} OBJECT ${arg_INTERVALS})
    set_target_properties(${intervals} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_include_directories(${intervals} PRIVATE ${PROJECT_SOURCE_DIR})
    target_link_libraries(${intervals} PRIVATE ${arg_USES} ${arg_PUBLIC} ${arg_PRIVATE} polyglide_options)
    target_compile_options(${intervals} PRIVATE -frounding-math)
    polyglide_precompile(${intervals} interval)
    list(APPEND sources $<TARGET_OBJECTS:${intervals}>)
  endif()
  add_library(polyglide_${name} STATIC ${sources} ${headers})
  add_library(polyglide::${name} ALIAS polyglide_${name})
  set_target_properties(polyglide_${name} PROPERTIES EXPORT_NAME ${name}
                                                     POSITION_INDEPENDENT_CODE ON
                                                     LINKER_LANGUAGE CXX)
  target_compile_features(polyglide_${name} PUBLIC cxx_std_20)
  target_include_directories(
    polyglide_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                             $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/polyglide>)
  target_link_libraries(polyglide_${name} PUBLIC ${arg_USES} ${arg_PUBLIC}
                        PRIVATE ${arg_PRIVATE} $<BUILD_INTERFACE:polyglide_options>)
  polyglide_precompile(polyglide_${name} library)
  install(TARGETS polyglide_${name} EXPORT polyglide COMPONENT dev)
  install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/polyglide/${name}
          COMPONENT dev)
endfunction()

# polyglide_add_kernels(<floor> <stem>)
#
# Flags of <floor>/<stem>_<instruction set>.cpp, of which the program chooses one at run
# time. The wide ones may contract a·b + c: their results differ from the scalar ones by
# rounding. No precompiled header: it holds for one set of flags only. The sanitizers see
# the scalar one, which is the same source: of registers the compiler would make minutes.
function(polyglide_add_kernels floor stem)
  set(flags_scalar -O3)
  set(flags_x86_64 -O3)
  set(flags_v3 -O3 -ffp-contract=fast -march=x86-64-v3)
  # GCC 12 warns of its own header of AVX-512 intrinsics.
  set(flags_v4 -O3 -ffp-contract=fast -march=x86-64-v4 -Wno-maybe-uninitialized
               -Wno-uninitialized)
  foreach(kind IN ITEMS scalar x86_64 v3 v4)
    set(source ${PROJECT_SOURCE_DIR}/${floor}/${stem}_${kind}.cpp)
    set_source_files_properties(${source} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
    if(POLYGLIDE_SANITIZE AND NOT kind STREQUAL scalar)
      list(APPEND flags_${kind} -fno-sanitize=all)
    endif()
    if(kind STREQUAL scalar OR CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
      set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS "${flags_${kind}}")
    endif()
  endforeach()
endfunction()
