// SPDX-License-Identifier: LGPL-3.0-or-later
/// The effects of the keys.
#include <algorithm>

#include "top/top.h"

namespace mauve::ctl {
namespace {

constexpr char kEscape = '\033';

bool is_printable(char byte) { return static_cast<unsigned char>(byte) >= 0x20 && byte != 0x7F; }

/// The bytes of a sequence that begins with an escape: "\033[A", "\033OA", "\033[5~".
std::size_t length_of_sequence(std::string_view bytes) {
  if (bytes.size() < 2 || (bytes[1] != '[' && bytes[1] != 'O')) return 1;
  std::size_t length = 2;
  while (length < bytes.size()) {
    const auto byte = static_cast<unsigned char>(bytes[length++]);
    if (byte >= 0x40 && byte <= 0x7E) break;
  }
  return length;
}

void add_sequence(std::string_view sequence, std::vector<Key>& keys) {
  if (sequence.size() == 1) return keys.push_back({Key::Kind::escape});
  if (sequence.size() != 3) return;
  if (sequence[2] == 'A') keys.push_back({Key::Kind::up});
  if (sequence[2] == 'B') keys.push_back({Key::Kind::down});
}

void type(TopView& view, const Key& key) {
  constexpr std::size_t kLongest = 64;
  switch (key.kind) {
    case Key::Kind::character:
      if (view.filter.size() < kLongest) view.filter += key.character;
      break;
    case Key::Kind::erase:
      if (!view.filter.empty()) view.filter.pop_back();
      break;
    case Key::Kind::enter:
      view.typing = false;
      break;
    case Key::Kind::escape:
      view.typing = false;
      view.filter.clear();
      break;
    default:
      break;
  }
}

void select(TopView& view, const std::vector<TopRow>& rows, bool down) {
  const auto at = selected_row(rows, view);
  if (!at) return;
  const std::size_t next = down ? std::min(*at + 1, rows.size() - 1) : *at - (*at > 0 ? 1 : 0);
  view.selected = rows[next].name;
}

/// Back from where one is: details, then the filter.
void leave(TopView& view) {
  if (!view.details) view.filter.clear();
  view.details = false;
}

void show_details(TopView& view, const std::vector<TopRow>& rows) {
  const auto at = selected_row(rows, view);
  if (at) view.selected = rows[*at].name;
  view.details = at && !view.details;
}

void choose(TopView& view, char letter, const std::vector<TopRow>& rows) {
  for (std::size_t i = 0; i < kTopSorts.size(); ++i) {
    if (kTopSorts[i].first == letter) view.sort = static_cast<TopSort>(i);
  }
  switch (letter) {
    case 'q':
      view.quit = true;
      break;
    case 's':
      view.sort =
          static_cast<TopSort>((static_cast<std::size_t>(view.sort) + 1) % kTopSorts.size());
      break;
    case 'f':
      view.typing = true;
      view.details = false;
      break;
    case 'p':
      view.paused = !view.paused;
      break;
    case 'd':
      show_details(view, rows);
      break;
    case '?':
      view.help = true;
      break;
    default:
      break;
  }
}

}  // namespace

std::vector<Key> keys_in(std::string_view bytes) {
  std::vector<Key> keys;
  while (!bytes.empty()) {
    std::size_t length = 1;
    const char byte = bytes.front();
    if (byte == kEscape) {
      length = length_of_sequence(bytes);
      add_sequence(bytes.substr(0, length), keys);
    } else if (byte == '\r' || byte == '\n') {
      keys.push_back({Key::Kind::enter});
    } else if (byte == '\b' || byte == 0x7F) {
      keys.push_back({Key::Kind::erase});
    } else if (is_printable(byte)) {
      keys.push_back({Key::Kind::character, byte});
    }
    bytes.remove_prefix(length);
  }
  return keys;
}

void press(TopView& view, const Key& key, const std::vector<TopRow>& rows) {
  if (view.typing) return type(view, key);
  if (view.help) {
    view.help = false;
    view.quit = key.character == 'q';
    return;
  }
  switch (key.kind) {
    case Key::Kind::character:
      return choose(view, key.character, rows);
    case Key::Kind::up:
      return select(view, rows, false);
    case Key::Kind::down:
      return select(view, rows, true);
    case Key::Kind::enter:
      return show_details(view, rows);
    case Key::Kind::escape:
      return leave(view);
    case Key::Kind::erase:
      return;
  }
}

}  // namespace mauve::ctl
