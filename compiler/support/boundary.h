// SPDX-License-Identifier: Apache-2.0
// What isoshade does with internal errors where it is only a part of a program: the libraries of include/isoshade return
// them to the caller.
#pragma once

#include <exception>
#include <string>
#include <string_view>

namespace isoshade::support {

/// Thrown by bug() after let_bugs_throw(). Nothing but the boundary of a library catches it.
class InternalError : public std::exception {
 public:
  explicit InternalError(std::string_view message) : message_(message) {}
  const char* what() const noexcept override { return message_.c_str(); }

 private:
  std::string message_;
};

/// From now on, bug() throws an InternalError in place of ending the process, in all threads.
void let_bugs_throw();

}  // namespace isoshade::support
