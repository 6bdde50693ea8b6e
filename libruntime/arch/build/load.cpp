// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/build/load.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "arch/build/build.h"
#include "arch/parse/parse.h"
#include "arch/text/json.h"
#include "mauve/host/architecture.h"
#include "plugin/load/catalog.h"
#include "rt/process/descriptor.h"

namespace mauve::arch {

namespace {

Error not_readable(const std::string& path) {
  return errno == ENOENT
             ? refuse({Errc::unknown_name, "file_not_found"}, path, "there is no such file")
             : refuse({Errc::system, "file_unreadable"}, path, std::strerror(errno));
}

}  // namespace

Result<std::string> read_file(const std::string& path, const plugin::Trust* trust) {
  const int follow = trust == nullptr ? 0 : O_NOFOLLOW;
  const rt::Descriptor file(
      ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC | follow));
  struct stat status {};
  if (!file || ::fstat(file.get(), &status) != 0) return not_readable(path);
  if (!S_ISREG(status.st_mode))
    return refuse({Errc::invalid_value, "file_not_regular"}, path, "is not a regular file");
  if (Status good = trust == nullptr ? ok() : trust->check(status, path); !good) {
    good.error().code = Errc::not_permitted;
    good.error().id = "path_not_trusted";
    return good.error();
  }
  std::string text(JsonLimits{}.bytes + 1, '\0');
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t got = ::read(file.get(), text.data() + done, text.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return not_readable(path);
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  text.resize(done);
  if (text.size() > JsonLimits{}.bytes) {
    return refuse({Errc::limit, "file_too_large"}, path,
                  "is longer than " + std::to_string(JsonLimits{}.bytes) + " bytes");
  }
  return text;
}

void load_plugins(const Spec& spec, plugin::Catalog& catalog, Problems& problems) {
  for (const PlacedText& plugin : spec.plugins) {
    if (catalog.find(plugin.value) != nullptr) continue;
    Status done = catalog.load(plugin.value);
    if (done) continue;
    done.error().at = "plugins." + plugin.value;
    problems.add(plugin.where, std::move(done.error()));
  }
}

std::unique_ptr<Architecture> load(std::string_view text, plugin::Catalog& catalog,
                                   Problems& problems, rules::Supervision* supervision,
                                   LostNames lost) {
  const std::optional<Spec> spec = parse(text, problems);
  if (!spec) return nullptr;
  load_plugins(*spec, catalog, problems);
  return build(*spec, catalog, problems, supervision, lost);
}

}  // namespace mauve::arch
