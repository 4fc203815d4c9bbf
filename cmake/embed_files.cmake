# cmake -DOUTPUT=file -DFOLDER=folder -DFILES=a,b -DPREFIX=isoshade/ -DHEADER=a.h -DNAMESPACE=isoshade::part -DTYPE=Type
#       -DFUNCTION=name -P embed_files.cmake
# Writes a C++ file that defines `std::span<const Type> name()`: the path of each file behind the prefix, and its text. HEADER
# declares both; Type consists of two std::string_view.
string(REPLACE "," ";" files "${FILES}")
set(text "// Made by cmake/embed_files.cmake.\n#include \"${HEADER}\"\n\n")
string(APPEND text "namespace ${NAMESPACE} {\nnamespace {\n\nconstexpr ${TYPE} files[] = {\n")
foreach(path IN LISTS files)
  file(READ "${FOLDER}/${path}" content)
  string(APPEND text "    {\"${PREFIX}${path}\", R\"isoshade(${content})isoshade\"},\n")
endforeach()
string(APPEND text "};\n\n}  // namespace\n\nstd::span<const ${TYPE}> ${FUNCTION}() { return files; }\n\n")
string(APPEND text "}  // namespace ${NAMESPACE}\n")
file(WRITE "${OUTPUT}" "${text}")
