# cmake -DOUTPUT=file -DFILES=a,b -DHEADER=a.h -DNAMESPACE=isoshade::part -DFUNCTION=name -P hash_files.cmake
# Writes a C++ file that defines `std::string_view name()`: a hash of the contents of the files. HEADER declares it.
string(REPLACE "," ";" files "${FILES}")
set(hashes "")
foreach(path IN LISTS files)
  file(SHA256 "${path}" hash)
  string(APPEND hashes "${hash}")
endforeach()
string(SHA256 hash "${hashes}")
file(WRITE "${OUTPUT}" "// Made by cmake/hash_files.cmake.
#include \"${HEADER}\"

namespace ${NAMESPACE} {

std::string_view ${FUNCTION}() { return \"${hash}\"; }

}  // namespace ${NAMESPACE}
")
