# SPDX-License-Identifier: Apache-2.0
# Writes ${PROJECT_BINARY_DIR}/generated/brdf_all.inc and shape_all.inc for the host: the row numbers CLRAY_BRDF_<id>,
# the #include lines of every row's file, and CLRAY_BRDFS(X) with X(id) for each row, from the rows of the .def files.
# So a new model or shape is one kernel file and one row, here as on the device (device/program.hpp). The row
# `triangle` is handled apart from the analytic shapes and is not in CLRAY_SHAPES.
function(clray_generate_table table macro)
  set(def ${PROJECT_SOURCE_DIR}/kernels/${table}/${table}.def)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${def})
  file(READ ${def} text)
  string(REGEX MATCHALL "\n${macro}\\([a-z0-9_]+," rows "${text}")
  set(numbers "")
  set(includes "")
  set(list "#define CLRAY_${macro}S(X)")
  set(row 0)
  foreach(id IN LISTS rows)
    string(REGEX REPLACE "\n${macro}\\(([a-z0-9_]+)," "\\1" id "${id}")
    string(APPEND numbers "#define CLRAY_${macro}_${id} ${row}u\n")
    math(EXPR row "${row} + 1")
    if(NOT id STREQUAL "triangle")
      string(APPEND includes "#include \"${table}/${id}.cl\"\n")
      string(APPEND list " X(${id})")
    endif()
  endforeach()
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/${table}_all.inc CONTENT
       "// Made by cmake/GenerateTables.cmake from ${table}.def.\n${numbers}${includes}${list}\n" @ONLY)
endfunction()

clray_generate_table(brdf BRDF)
clray_generate_table(shape SHAPE)
