# cmake -DOUTPUT=file -DFOLDER=folder -DHEADERS=a.h,b.h -P embed_headers.cmake
# Writes a C++ file that defines lanes_headers() with the texts of the headers, as isoshade/lanes/a.h and so on.
string(REPLACE "," ";" headers "${HEADERS}")
set(text "// Made by backends/cpu/embed_headers.cmake.\n#include \"backends/cpu/compiler.h\"\n\n")
string(APPEND text "namespace isoshade::cpu {\nnamespace {\n\nconstexpr Header headers[] = {\n")
foreach(header IN LISTS headers)
  file(READ "${FOLDER}/${header}" content)
  string(APPEND text "    {\"isoshade/lanes/${header}\", R\"isoshade(${content})isoshade\"},\n")
endforeach()
string(APPEND text "};\n\n}  // namespace\n\nstd::span<const Header> lanes_headers() { return headers; }\n\n")
string(APPEND text "}  // namespace isoshade::cpu\n")
file(WRITE "${OUTPUT}" "${text}")
