# abbe_unity(target): its sources are compiled as one unit a folder, because headers cost more than what is in
# the files. So names in anonymous namespaces are unique within a folder; -DABBE_UNITY=OFF compiles each file by itself.
function(abbe_unity target)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ${ABBE_UNITY} UNITY_BUILD_BATCH_SIZE 0)
endfunction()

# abbe_rarely_run(target…): code that takes longer to compile than it ever runs: commands, reports, tables of fields.
function(abbe_rarely_run)
    foreach(target IN LISTS ARGN)
        if(ABBE_SANITIZE)
            target_compile_options(${target} PRIVATE -O0) # two thirds to compile of -O1
        else()
            target_compile_options(${target} PRIVATE -O1) # two thirds to compile of -O2
        endif()
    endforeach()
endfunction()

# abbe_library(name folder DEPS … PRIVATE_DEPS …): the library of one folder, abbe::name. A folder without
# sources (render: interfaces only) becomes an INTERFACE library. Project includes are written from the
# top: "base/check.h" for src/base, "parser/scanner.h", "materials/diffuse.h".
function(abbe_library name folder)
    cmake_parse_arguments(A "" "" "DEPS;PRIVATE_DEPS" ${ARGN})
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.cpp)
    list(FILTER sources EXCLUDE REGEX "/main\\.cpp$")
    if(sources)
        add_library(abbe_${name} STATIC ${sources})
        target_include_directories(abbe_${name} PUBLIC ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR})
        target_link_libraries(abbe_${name} PUBLIC ${A_DEPS} PRIVATE ${A_PRIVATE_DEPS})
        abbe_unity(abbe_${name})
        if(ABBE_COVERAGE)
            target_compile_options(abbe_${name} PRIVATE -fsanitize-coverage=trace-pc)
        endif()
    else()
        add_library(abbe_${name} INTERFACE)
        target_include_directories(abbe_${name} INTERFACE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR})
        target_link_libraries(abbe_${name} INTERFACE ${A_DEPS})
    endif()
    add_library(abbe::${name} ALIAS abbe_${name})
endfunction()

# The main program of every test, compiled once: doctest's own code is as much as ten tests.
add_library(abbe_doctest_main OBJECT ${PROJECT_SOURCE_DIR}/tests/support/doctest_main.cpp)

# abbe_test(name folders DEPS … LABEL …): one doctest executable from every .cpp of some folders under tests/.
function(abbe_test name folders)
    cmake_parse_arguments(A "INPUT" "LABEL" "DEPS" ${ARGN})
    list(TRANSFORM folders REPLACE "(.+)" "${PROJECT_SOURCE_DIR}/tests/\\1/*.cpp")
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${folders})
    if(NOT sources)
        return()
    endif()
    add_executable(test_${name} ${sources} $<TARGET_OBJECTS:abbe_doctest_main>)
    target_include_directories(test_${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
    target_link_libraries(test_${name} PRIVATE ${A_DEPS})
    target_compile_definitions(test_${name} PRIVATE ABBE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    abbe_unity(test_${name})
    if(A_LABEL STREQUAL quick OR ABBE_SANITIZE)
        abbe_rarely_run(test_${name})
    endif()
    add_test(NAME ${name} COMMAND test_${name})
    if(A_LABEL STREQUAL quick)
        add_dependencies(quick_tests test_${name})
        if(A_INPUT)
            add_dependencies(input_tests test_${name})
            list(APPEND A_LABEL input)
        endif()
    endif()
    set_tests_properties(${name} PROPERTIES LABELS "${A_LABEL}")
endfunction()
