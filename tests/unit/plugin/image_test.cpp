// SPDX-License-Identifier: LGPL-3.0-or-later
#include "plugin/elf/image.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <string>

namespace mauve::plugin {
namespace {

/// A memory file of one page, to which a pipe holds a reference.
class HeldPage {
 public:
  HeldPage() : file_(memfd_create("held", MFD_CLOEXEC | MFD_ALLOW_SEALING)) {
    std::array<int, 2> ends{};
    EXPECT_EQ(pipe2(ends.data(), O_CLOEXEC), 0);
    out_ = rt::Descriptor(ends[0]);
    in_ = rt::Descriptor(ends[1]);
    const std::string page(kSize, 'a');
    EXPECT_EQ(write(file_.get(), page.data(), page.size()), kSize);
    off_t from = 0;
    EXPECT_EQ(splice(file_.get(), &from, in_.get(), nullptr, kSize, 0), kSize);
  }
  void let_go() {
    std::array<char, kSize> bytes{};
    EXPECT_EQ(read(out_.get(), bytes.data(), bytes.size()), kSize);
  }
  [[nodiscard]] int file() const { return file_.get(); }

 private:
  static constexpr ssize_t kSize = 4096;
  rt::Descriptor file_;
  rt::Descriptor out_;
  rt::Descriptor in_;
};

TEST(Seal, WaitsUntilNoOtherPartOfTheKernelHoldsAPage) {
  HeldPage held;
  int retries = 0;

  const Status sealed = seal_file(held.file(), [&] {
    if (++retries == 2) held.let_go();
  });

  EXPECT_TRUE(sealed) << to_string(sealed.error());
  EXPECT_GE(retries, 2);
  EXPECT_LT(write(held.file(), "b", 1), 0) << "the file is constant";
}

TEST(Seal, EndsWithARefusalWhenAPageIsHeldForEver) {
  HeldPage held;
  int retries = 0;

  const Status sealed = seal_file(held.file(), [&] { ++retries; });

  ASSERT_FALSE(sealed);
  EXPECT_EQ(sealed.error().code, Errc::system);
  EXPECT_EQ(retries, 9);
}

}  // namespace
}  // namespace mauve::plugin
