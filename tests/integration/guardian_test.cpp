// SPDX-License-Identifier: LGPL-3.0-or-later
// The guardian by itself: a stand-in for mauved in this process greets it, hands outputs over, and
// ends or falls silent.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <optional>

#include "rt/guardian/guardian_link.h"
#include "support/outlet.h"
#include "support/process.h"
#include "support/temp_dir.h"

namespace mauve::test {
namespace {

namespace wire = rt::guardian;
using testing::HasSubstr;
using testing::Not;

constexpr int kSeals = F_SEAL_SHRINK | F_SEAL_GROW;

/// A guardian that serves one stand-in after another.
class Served {
 public:
  Served() : process_({MAUVE_BIN_DIR "/mauve-guardian", "--socket", socket()}, log_) {}

  [[nodiscard]] std::string socket() const { return (place_ / "guardian").string(); }
  [[nodiscard]] bool says(const std::string& text) const {
    return eventually([&] { return said().find(text) != std::string::npos; });
  }
  [[nodiscard]] std::string said() const { return TempDir::read(log_); }
  [[nodiscard]] int connected() const {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    socket().copy(address.sun_path, sizeof address.sun_path - 1);
    const int one = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
    EXPECT_TRUE(eventually([&] {
      return connect(one, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    }));
    return one;
  }

 private:
  TempDir place_;
  std::string log_ = (place_ / "log").string();
  Process process_;
};

/// Stands in for a mauved: it sends requests to the guardian, and shares a page with the guardian.
class StandIn {
 public:
  explicit StandIn(const Served& guardian, int seals = kSeals) : socket_(guardian.connected()) {
    file_ = memfd_create("page", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    EXPECT_EQ(ftruncate(file_, sizeof(wire::Page)), 0);
    EXPECT_EQ(fcntl(file_, F_ADD_SEALS, seals), 0);
    void* const page =
        mmap(nullptr, sizeof(wire::Page), PROT_READ | PROT_WRITE, MAP_SHARED, file_, 0);
    page_ = static_cast<wire::Page*>(page);
    page_->owner = wire::owner_word(gettid());
  }
  ~StandIn() {
    end();
    close(file_);
    munmap(page_, sizeof(wire::Page));
  }
  StandIn(const StandIn&) = delete;
  StandIn& operator=(const StandIn&) = delete;

  wire::Answer greet(std::uint32_t silence_ms = 0) {
    wire::Request hello;
    hello.thread = gettid();
    hello.silence_ms = silence_ms;
    return ask(hello, file_);
  }
  wire::Answer hold(std::uint32_t slot, const wire::Order& order, int descriptor) {
    wire::Request request;
    request.kind = wire::Kind::hold;
    request.slot = slot;
    request.order = order;
    auto answer = ask(request, descriptor);
    close(descriptor);
    return answer;
  }
  wire::Answer say(wire::Kind kind, std::uint32_t slot = 0) {
    wire::Request request;
    request.kind = kind;
    request.slot = slot;
    return ask(request, -1);
  }
  wire::Answer ask(wire::Request request, int descriptor) {
    request.number = ++number_;
    EXPECT_TRUE(wire::send(socket_, request, descriptor));
    return next();
  }
  /// Without waiting for the answer; the number of the request.
  std::uint32_t tell(wire::Kind kind) {
    wire::Request request;
    request.kind = kind;
    request.number = ++number_;
    EXPECT_TRUE(wire::send(socket_, request, -1));
    return request.number;
  }
  [[nodiscard]] wire::Answer next() const {
    wire::Answer answer;
    EXPECT_EQ(recv(socket_, &answer, sizeof answer, 0), static_cast<ssize_t>(sizeof answer));
    return answer;
  }
  [[nodiscard]] wire::Page& page() const { return *page_; }
  /// Its connection, as when a process ends or loses all descriptors.
  void end() {
    if (socket_ >= 0) close(std::exchange(socket_, -1));
  }

 private:
  int socket_;
  int file_ = -1;
  wire::Page* page_ = nullptr;
  std::uint32_t number_ = 0;
};

wire::Order order(const std::string& name, const std::string& bytes) {
  wire::Order made;
  name.copy(made.name.data(), made.name.size() - 1);
  std::copy(bytes.begin(), bytes.end(), made.bytes.begin());
  made.size = static_cast<std::uint32_t>(bytes.size());
  return made;
}

class GuardianProgram : public testing::Test {
 protected:
  /// A greeted stand-in that has handed over one order for the outlet.
  void hold(const wire::Order& one) {
    ASSERT_EQ(stand_in_->greet().done, 1U);
    ASSERT_EQ(stand_in_->hold(0, one, outlet_.opened()).done, 1U);
  }
  /// Once another one is greeted, the first is over and done with.
  void wait_for_the_end() {
    stand_in_->end();
    EXPECT_EQ(StandIn(guardian_).greet().done, 1U);
  }

  Served guardian_;
  Outlet outlet_;
  std::optional<StandIn> stand_in_{std::in_place, guardian_};
};

TEST_F(GuardianProgram, SendsItsOrdersWhenTheConnectionEndsWithoutAWord) {
  Outlet other;
  hold(order("first", "stand"));
  ASSERT_EQ(stand_in_->hold(1, order("second", "off"), other.opened()).done, 1U);

  wait_for_the_end();

  EXPECT_EQ(outlet_.bytes(), "stand");
  EXPECT_EQ(other.bytes(), "off");
  EXPECT_THAT(guardian_.said(), HasSubstr("2 of 2 outputs were put into their safe state"));
}

TEST_F(GuardianProgram, SendsNothingAfterAGoodbye) {
  hold(order("first", "stand"));

  EXPECT_EQ(stand_in_->say(wire::Kind::bye).done, 1U);
  wait_for_the_end();

  EXPECT_EQ(outlet_.bytes(), "");
  EXPECT_THAT(guardian_.said(), HasSubstr("ended in order"));
}

TEST_F(GuardianProgram, SendsNothingToADeviceThatWasLetGo) {
  hold(order("first", "stand"));

  EXPECT_EQ(stand_in_->say(wire::Kind::drop, 0).done, 1U);
  wait_for_the_end();

  EXPECT_EQ(outlet_.bytes(), "");
}

TEST_F(GuardianProgram, SendsTheOrderThatReplacedAnother) {
  hold(order("first", "old"));
  ASSERT_EQ(stand_in_->hold(0, order("first", "new"), outlet_.opened()).done, 1U);

  wait_for_the_end();

  EXPECT_EQ(outlet_.bytes(), "new");
}

TEST_F(GuardianProgram, SendsAnOrderAsOftenAsItSays) {
  auto often = order("first", "stand ");
  often.times = 3;
  often.apart_us = 5'000;
  hold(often);

  wait_for_the_end();

  EXPECT_EQ(outlet_.bytes(), "stand stand stand ");
}

TEST_F(GuardianProgram, DropsWhatWaitsToBeSentWhereTheOrderSaysSo) {
  outlet_.fill();
  auto alone = order("first", "stand");
  alone.drop_unsent = 1;
  hold(alone);

  wait_for_the_end();

  EXPECT_THAT(guardian_.said(), HasSubstr("1 of 1 outputs were put into their safe state"));
  EXPECT_THAT(outlet_.bytes(), testing::EndsWith("stand"));
}

TEST_F(GuardianProgram, GivesUpADeviceThatTakesNothingAndServesTheOthers) {
  Outlet full;
  full.fill();
  hold(order("first", "stand"));
  ASSERT_EQ(stand_in_->hold(1, order("deaf", "stand"), full.opened()).done, 1U);

  wait_for_the_end();

  EXPECT_EQ(outlet_.bytes(), "stand");
  EXPECT_THAT(guardian_.said(), HasSubstr("deaf did not take its order (sent 0 of 1 times)"));
  EXPECT_THAT(guardian_.said(), HasSubstr("1 of 2 outputs were put into their safe state"));
}

TEST_F(GuardianProgram, RefusesADescriptorThatWouldMakeItWait) {
  ASSERT_EQ(stand_in_->greet().done, 1U);

  const auto answer = stand_in_->hold(0, order("first", "stand"), outlet_.opened(0));

  EXPECT_EQ(answer.done, 0U);
  EXPECT_THAT(answer.text.data(), HasSubstr("O_NONBLOCK"));
}

TEST_F(GuardianProgram, RefusesAnOrderThatCannotBeOne) {
  ASSERT_EQ(stand_in_->greet().done, 1U);
  auto too_often = order("first", "stand");
  too_often.times = 11;
  auto too_long = order("first", "stand");
  too_long.times = 2;
  too_long.apart_us = 100'000;

  EXPECT_EQ(stand_in_->hold(0, order("first", ""), outlet_.opened()).done, 0U);
  EXPECT_EQ(stand_in_->hold(0, too_often, outlet_.opened()).done, 0U);
  EXPECT_EQ(stand_in_->hold(0, too_long, outlet_.opened()).done, 0U);
  EXPECT_EQ(stand_in_->hold(wire::kMostOutputs, order("first", "x"), outlet_.opened()).done, 0U);
}

TEST_F(GuardianProgram, RefusesAPageThatCouldBeRemoved) {
  stand_in_.emplace(guardian_, F_SEAL_GROW);

  EXPECT_EQ(stand_in_->greet().done, 0U);
}

TEST_F(GuardianProgram, BelievesAPageNoFurtherThanTheKernel) {
  hold(order("first", "stand"));

  stand_in_->page().owner = FUTEX_OWNER_DIED;

  EXPECT_TRUE(guardian_.says("overwrote the page"));
  EXPECT_EQ(outlet_.bytes(), "");
  wait_for_the_end();
  EXPECT_EQ(outlet_.bytes(), "stand") << "its end is noticed all the same";
}

TEST_F(GuardianProgram, TakesASilenceForAnEndAndHearsWhenItIsOver) {
  ASSERT_EQ(stand_in_->greet(60).done, 1U);
  ASSERT_EQ(stand_in_->hold(0, order("first", "stand"), outlet_.opened()).done, 1U);

  ++stand_in_->page().beats;
  const auto silence = stand_in_->next();

  EXPECT_EQ(silence.kind, wire::Kind::silence);
  EXPECT_EQ(silence.done, 1U);
  EXPECT_GE(silence.lasted_ms, 60U);
  EXPECT_EQ(outlet_.bytes(), "stand");
  ++stand_in_->page().beats;
  EXPECT_TRUE(guardian_.says("is heard again"));
  EXPECT_EQ(stand_in_->next().kind, wire::Kind::silence) << "another silence";
  EXPECT_EQ(outlet_.bytes(), "standstand");
}

TEST_F(GuardianProgram, WaitsForTheFirstBeatBeforeItWatchesForSilence) {
  ASSERT_EQ(stand_in_->greet(20).done, 1U);
  ASSERT_EQ(stand_in_->hold(0, order("first", "stand"), outlet_.opened()).done, 1U);

  for (int i = 0; i < 30; ++i) {
    EXPECT_EQ(stand_in_->say(wire::Kind::drop, 1).kind, wire::Kind::answer);
  }

  EXPECT_EQ(outlet_.bytes(), "");
  EXPECT_THAT(guardian_.said(), Not(HasSubstr("silent")));
}

TEST_F(GuardianProgram, SendsItsOrdersOnceMoreWhenAsked) {
  hold(order("first", "stand"));

  EXPECT_EQ(stand_in_->say(wire::Kind::again).done, 1U);

  EXPECT_EQ(outlet_.bytes(), "stand");
}

TEST_F(GuardianProgram, AnswersWhenItIsAskedWhetherItServes) {
  hold(order("first", "stand"));

  EXPECT_EQ(stand_in_->say(wire::Kind::ask).done, 1U);

  EXPECT_EQ(outlet_.bytes(), "");
}

TEST_F(GuardianProgram, AnswersWhileADeviceKeepsItBusy) {
  outlet_.fill();
  hold(order("deaf", "stand"));

  const auto orders = stand_in_->tell(wire::Kind::again);
  const auto question = stand_in_->tell(wire::Kind::ask);

  EXPECT_EQ(stand_in_->next().number, question);
  EXPECT_EQ(stand_in_->next().number, orders) << "when the device had its time to take the order";
}

}  // namespace
}  // namespace mauve::test
