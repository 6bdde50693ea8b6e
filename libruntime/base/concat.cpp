// SPDX-License-Identifier: LGPL-3.0-or-later
#include "base/concat.h"

namespace mauve {

std::string concat(std::initializer_list<TextPart> parts) {
  std::size_t size = 0;
  for (const TextPart& part : parts) size += part.text().size();
  std::string text;
  text.reserve(size);
  for (const TextPart& part : parts) text += part.text();
  return text;
}

}  // namespace mauve
