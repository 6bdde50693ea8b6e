// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <string>
#include <string_view>

#include <mauve/serial/line_requests.h>

namespace mauve::test {
namespace {

using mauve::serial::LineOrders;
using mauve::serial::LineRequests;

class Requests : public testing::Test {
 protected:
  Requests() { requests_.begin(orders_, 100); }

  /// So many bytes go out.
  void write(std::size_t count) {
    for (auto rest = requests_.next(); count > 0 && !rest.empty(); rest = requests_.next()) {
      const std::string_view some = rest.substr(0, count);
      heard_ += some;
      count -= some.size();
      requests_.written(some.size());
    }
  }
  /// All that the device has heard in the end.
  std::string all() {
    write(10'000);
    return heard_;
  }

  std::shared_ptr<LineOrders> orders_ = std::make_shared<LineOrders>();
  LineRequests requests_;
  std::string heard_;
};

TEST_F(Requests, GoOutInTheirOrderAndWhole) {
  EXPECT_TRUE(requests_.put("one "));
  EXPECT_TRUE(requests_.put("two "));
  EXPECT_TRUE(requests_.put("")) << "nothing is no request, and blocks none";
  EXPECT_TRUE(requests_.put("three"));
  EXPECT_EQ(all(), "one two three");
}

TEST_F(Requests, AreRefusedWholeWhenTooMuchWaits) {
  EXPECT_TRUE(requests_.put(std::string(90, 'a')));
  EXPECT_FALSE(requests_.put(std::string(10, 'b'))) << "each counts four bytes more";
  EXPECT_TRUE(requests_.put("cc"));
  EXPECT_EQ(all(), std::string(90, 'a') + "cc");
}

TEST_F(Requests, AreDroppedByAnOrderBeforeTheyBegin) {
  EXPECT_TRUE(requests_.put("go"));
  EXPECT_TRUE(requests_.put("go on"));
  orders_->give("halt");
  EXPECT_TRUE(requests_.put("later"));
  EXPECT_EQ(all(), "later") << "the one who gives the order sends it as well";
}

TEST_F(Requests, AreFollowedByAnOrderThatCameAfterTheyHadBegun) {
  EXPECT_TRUE(requests_.put("go"));
  write(1);
  orders_->give("halt");
  EXPECT_EQ(all(), "gohalt");
}

TEST_F(Requests, AreFollowedByTheNewestOrderAlone) {
  EXPECT_TRUE(requests_.put("go"));
  write(1);
  orders_->give("old");
  write(1);
  orders_->give("new");
  EXPECT_EQ(all(), "gonew") << "the older one had not begun";
}

TEST_F(Requests, AreFollowedByANewerOrderAlsoWhenAnOlderOneIsGoingOut) {
  EXPECT_TRUE(requests_.put("go"));
  write(1);
  orders_->give("old");
  write(2);
  orders_->give("new");
  EXPECT_EQ(all(), "gooldnew");
}

TEST_F(Requests, GoOutWholeToTheNextDevice) {
  EXPECT_TRUE(requests_.put("stand"));
  write(3);
  requests_.again();
  EXPECT_EQ(all(), "stastand");
}

TEST_F(Requests, AreForgottenWhenTheirDeviceIsGone) {
  EXPECT_FALSE(requests_.drop()) << "none waited";
  EXPECT_TRUE(requests_.put("go"));
  write(1);
  EXPECT_TRUE(requests_.put("on"));
  EXPECT_TRUE(requests_.drop());
  EXPECT_TRUE(requests_.put("anew"));
  EXPECT_EQ(all(), "ganew");
}

/// A request is a word of one letter, and each order begins the next letter. The line of the one
/// who gives an order writes it at once. Behind an old letter there is an order, whatever goes out
/// in whatever pieces.
TEST_F(Requests, AreNeverTheLastWordAfterAnOrderThatCameLater) {
  std::mt19937 chance(1);
  const auto below = [&chance](unsigned limit) { return static_cast<unsigned>(chance() % limit); };
  char letter = 'a';
  for (int flush = 0; flush < 2'000; ++flush) {
    heard_.clear();
    for (unsigned steps = below(20); steps > 0; --steps) {
      if (below(3) > 0) static_cast<void>(requests_.put(std::string(1 + below(40), letter)));
      if (below(3) > 0) write(1 + below(30));
      if (below(5) > 0) continue;
      orders_->give("!!");
      heard_ += "!!";
      letter = letter == 'z' ? 'a' : static_cast<char>(letter + 1);
    }
    static_cast<void>(all());
    const auto last_order = heard_.rfind('!');
    if (last_order == std::string::npos) continue;
    const std::string after = heard_.substr(last_order + 1);
    ASSERT_EQ(after, std::string(after.size(), letter)) << heard_;
  }
}

}  // namespace
}  // namespace mauve::test
