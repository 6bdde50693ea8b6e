// SPDX-License-Identifier: LGPL-3.0-or-later
#include "mtrace/convert.h"

#include "cli/files.h"
#include "mtrace/chrome.h"
#include "mtrace/ctf.h"
#include "mtrace/file.h"

namespace mauve::ctl::mtrace {

std::optional<Format> format_named(std::string_view name) {
  if (name == "mtrace") return Format::mtrace;
  if (name == "chrome") return Format::chrome;
  if (name == "ctf") return Format::ctf;
  return std::nullopt;
}

Format format_of(std::string_view path) {
  if (path.ends_with(".mtrace")) return Format::mtrace;
  return path.ends_with(".json") ? Format::chrome : Format::ctf;
}

std::string_view begin_of(Format format) {
  if (format == Format::mtrace) return R"({"architecture":")";
  return format == Format::chrome ? R"({"displayTimeUnit")" : "/* CTF 1.8 */";
}

Status convert(const Trace& trace, Format format, const std::string& path) {
  if (format == Format::ctf) return write_ctf(trace, path);
  return write_file(path, [&](std::ostream& out) {
    format == Format::chrome ? write_chrome(trace, out) : write(trace, out);
  });
}

}  // namespace mauve::ctl::mtrace
