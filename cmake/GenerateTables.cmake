# SPDX-License-Identifier: Apache-2.0
# Writes ${PROJECT_BINARY_DIR}/generated/<table>_all.inc for the host, from the rows of the .def files: the row numbers
# CLRAY_<TABLE>_<id>, the #include lines of the rows' files, and CLRAY_<TABLE>S(X) with X(id) for each row. So a new
# row is one kernel file and one line, here as on the device (device/program.hpp). Shapes with the trait `faces` are not
# in CLRAY_SHAPES: walks test them by themselves.
set(clray_text "\"([^\"]*)\"")

function(clray_rows table macro rows)
  set(def ${PROJECT_SOURCE_DIR}/kernels/${table}/${table}.def)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${def})
  file(READ ${def} text)
  string(REGEX REPLACE "[][;]" "," text "${text}")  # they mean something in CMake's lists
  string(REGEX REPLACE "\n +" " " text "${text}")  # a row over several lines is one,
  string(REGEX REPLACE "\" +\"" "" text "${text}")  # and so are its parts of a text
  string(REGEX MATCHALL "\n${macro}\\([a-z0-9_]+,[^\n]*" found "${text}")
  set(${rows} "${found}" PARENT_SCOPE)
endfunction()

function(clray_write table text)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/${table} CONTENT
       "// Made by cmake/GenerateTables.cmake from the .def files under kernels/.\n${text}" @ONLY)
endfunction()

function(clray_generate_table table macro)
  clray_rows(${table} ${macro} rows)
  set(numbers "")
  set(includes "")
  set(list "#define CLRAY_${macro}S(X)")
  set(row 0)
  foreach(line IN LISTS rows)
    string(REGEX REPLACE "\n${macro}\\(([a-z0-9_]+),.*" "\\1" id "${line}")
    string(APPEND numbers "#define CLRAY_${macro}_${id} ${row}u\n")
    math(EXPR row "${row} + 1")
    string(APPEND includes "#include \"${table}/${id}.cl\"\n")
    if(NOT line MATCHES "\\(${id}, ${clray_text}, \"[^\"]*faces")
      string(APPEND list " X(${id})")
    endif()
  endforeach()
  clray_write(${table}_all.inc "${numbers}${includes}${list}\n")
endfunction()

# Detectors, for the kernels on the host (host/pipeline/host_pass.cpp): the files of those that look at moments of a
# path; CLRAY_HOOK_<hook>(X); and CLRAY_PROGRAM_NUMBERS(X) with X(name) for every number that a device's program is
# built with (host/pipeline/specialise.cpp), there read from `numbers`.
function(clray_generate_detectors)
  clray_rows(detector DETECTOR rows)
  set(includes "")
  set(names LANES CONNECTIONS KEPT CONNECT SCATTER SHADOW DELTA ONE_SIDED PLANES PIECES INSTANCED WIDE STRATA SOBOL
    PIXELS MIRRORS_FIRST SKIP_FIRST SKIP_PUSH CURVED)
  foreach(hook hit connect scatter escape end flush)
    set(hook_${hook} "#define CLRAY_HOOK_${hook}(X)")
  endforeach()
  foreach(line IN LISTS rows)
    if(NOT line MATCHES "\nDETECTOR\\(([a-z0-9_]+), ${clray_text}, ${clray_text}, ${clray_text}, ${clray_text},")
      message(FATAL_ERROR "detector.def: cannot read ${line}")
    endif()
    set(id ${CMAKE_MATCH_1})
    string(REPLACE " " ";" hooks "${CMAKE_MATCH_4}")
    string(REPLACE "," ";" sums "${CMAKE_MATCH_5}")
    if(hooks)
      string(APPEND includes "#include \"detector/${id}.cl\"\n")
    endif()
    foreach(hook IN LISTS hooks)
      string(APPEND hook_${hook} " X(${id})")
    endforeach()
    list(APPEND names COUNT_${id} FIRST_${id})
    foreach(sum IN LISTS sums)
      # A row that is kept only where it is small is never kept on the host.
      if(sum MATCHES "^ *([a-z0-9_]+) [a-z]+ [^ ]+ (kept|item)_")
        list(APPEND names KEPT_${id}_${CMAKE_MATCH_1})
      endif()
    endforeach()
  endforeach()
  clray_write(detector_all.inc "${includes}")
  set(list "#define CLRAY_PROGRAM_NUMBERS(X)")
  set(defines "")
  foreach(name IN LISTS names)
    string(APPEND list " X(CLRAY_${name})")
    string(APPEND defines "#define CLRAY_${name} numbers.CLRAY_${name}_\n")
  endforeach()
  clray_write(program_numbers.inc
    "${list}\n${defines}${hook_hit}\n${hook_connect}\n${hook_scatter}\n${hook_escape}\n${hook_end}\n${hook_flush}\n")
endfunction()

clray_generate_table(brdf BRDF)
clray_generate_table(shape SHAPE)
clray_generate_detectors()
clray_write(walk_all.inc "#include \"walk/exhaustive.cl\"\n")
