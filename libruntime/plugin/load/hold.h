// SPDX-License-Identifier: LGPL-3.0-or-later
/// Objects of a plugin that keep its code mapped. The code that does so lives in libmauve.
#pragma once

#include <memory>
#include <string>

#include "mauve/detail/element_type.h"
#include "mauve/type.h"
#include "plugin/load/library.h"

namespace mauve::plugin {

/// One registered user of a library, for as long as it lives.
class Hold {
 public:
  /// `user` is the name of a type, or the whole text of the entry in the list.
  Hold(std::shared_ptr<Library> library, std::string user);
  Hold(const Hold&) = delete;
  Hold& operator=(const Hold&) = delete;
  ~Hold();

  /// From now on the user is listed with this address. [factory]
  void place(const std::string& address);

 private:
  std::shared_ptr<Library> library_;
  Library::Users::iterator user_;
};

/// The user of a data type in the list of a library: "data type odometry/2".
[[nodiscard]] std::string user_of_type(const std::string& type);

/// A maker whose objects hold the library, and whose states do too. It does not hold the library
/// itself, and throws std::runtime_error when the library was retired or is gone. `plain` belongs
/// to the declarations of the library; `name` is the type's.
detail::Make<Shell> keep(const std::shared_ptr<Library>& library, const detail::Make<Shell>& plain,
                         const std::string& name);
detail::Make<CoreBase> keep(const std::shared_ptr<Library>& library,
                            const detail::Make<CoreBase>& plain, const std::string& name);
detail::Make<FsmBase> keep(const std::shared_ptr<Library>& library,
                           const detail::Make<FsmBase>& plain, const std::string& name);
detail::Make<InterfaceBase> keep(const std::shared_ptr<Library>& library,
                                 const detail::Make<InterfaceBase>& plain, const std::string& name);

/// The description of a data type, holding the library it lies in.
std::shared_ptr<const DataType> keep(const std::shared_ptr<Library>& library, const DataType& type);

}  // namespace mauve::plugin
