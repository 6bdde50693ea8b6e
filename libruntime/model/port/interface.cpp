// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/interface.h>

#include <string_view>

#include "model/element/find_named.h"

#include <mauve/service.h>

namespace mauve {

ServiceBase* InterfaceBase::find_service(std::string_view name) const {
  return find_named(services_, name);
}

}  // namespace mauve
