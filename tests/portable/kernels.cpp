// SPDX-License-Identifier: Apache-2.0
//
// kernels INPUTS RESULTS: runs every kernel of lanes_kernels.cpp, compiled for one lane of this processor, on blocks
// of operands. A block of INPUTS has two uniform operands and three columns of `block` ints.
#include <cstdio>
#include <vector>

#include "isoshade/lanes/lanes.h"
#include "tests/unit/lanes_operands.h"

using namespace isoshade::lanes;

int main(int count, char** arguments) {
  if (count != 3) return 2;
  FILE* in = std::fopen(arguments[1], "rb");
  FILE* out = std::fopen(arguments[2], "wb");
  if (in == nullptr || out == nullptr) return 3;
  const test::KernelTable& table = test::kernels_portable();
  std::vector<int> words(2 + 3 * test::block), results(test::block);
  while (std::fread(words.data(), sizeof(int), words.size(), in) == words.size()) {
    const int* columns = words.data() + 2;
    const test::Inputs inputs = {{columns, columns + test::block, columns + 2 * test::block},
                                 test::block,
                                 {words[0], words[1]},
                                 test::float_table().data(),
                                 test::int_table.data(),
                                 static_cast<int>(test::int_table.size())};
    for (int kernel = 0; kernel < table.count; ++kernel) {
      {
        const FpGuard guard;
        table.kernels[kernel].run(inputs, results.data());
      }
      std::fwrite(results.data(), sizeof(int), results.size(), out);
    }
  }
  return std::fclose(out) == 0 ? 0 : 4;
}
