// SPDX-License-Identifier: LGPL-3.0-or-later
/// iceoryx, its daemon RouDi inside this process: values lie in shared memory, which a writer
/// borrows and a reader gives back. The reader's queue has one place; a newer value replaces it.
#include <cstring>

#include "bench/peers/peer.h"

#include <iceoryx_hoofs/log/logmanager.hpp>
#include <iceoryx_posh/iceoryx_posh_config.hpp>
#include <iceoryx_posh/internal/roudi/roudi.hpp>
#include <iceoryx_posh/popo/untyped_publisher.hpp>
#include <iceoryx_posh/popo/untyped_subscriber.hpp>
#include <iceoryx_posh/roudi/iceoryx_roudi_components.hpp>
#include <iceoryx_posh/runtime/posh_runtime_single_process.hpp>

namespace bench::peers {
namespace {

iox::RouDiConfig_t some_memory() {
  iox::log::LogManager::GetLogManager().SetDefaultLogLevel(iox::log::LogLevel::kWarn);
  iox::mepoo::MePooConfig pools;
  for (const std::uint32_t size : {1024U, 16U * 1024, 128U * 1024}) pools.addMemPool({size, 16});
  iox::RouDiConfig_t config;
  const auto group = iox::posix::PosixGroup::getGroupOfCurrentProcess().getName();
  config.m_sharedMemorySegments.push_back({group, group, pools});
  return config;
}

/// For all peers of this process, to its end.
struct Daemon {
  iox::roudi::IceOryxRouDiComponents components{some_memory()};
  iox::roudi::RouDi roudi{
      components.rouDiMemoryManager, components.portManager,
      iox::roudi::RouDi::RoudiStartupParameters{iox::roudi::MonitoringMode::OFF, false}};
  iox::runtime::PoshRuntimeSingleProcess runtime{"mauve_peers"};
};

iox::popo::SubscriberOptions one_place() {
  iox::popo::SubscriberOptions options;
  options.queueCapacity = 1;
  return options;
}

class Iceoryx : public Peer {
 public:
  explicit Iceoryx(std::size_t size) : size_(static_cast<std::uint32_t>(size)) {}

  void write(const void* data) override {
    publisher_.loan(size_).and_then([&](void* chunk) {
      std::memcpy(chunk, data, size_);
      publisher_.publish(chunk);
    });
  }
  void read(void* into) override {
    subscriber_.take().and_then([&](const void* chunk) {
      std::memcpy(into, chunk, size_);
      subscriber_.release(chunk);
    });
  }

 private:
  std::uint32_t size_;
  iox::popo::UntypedPublisher publisher_{{"mauve", "bench", "peers"}};
  iox::popo::UntypedSubscriber subscriber_{{"mauve", "bench", "peers"}, one_place()};
};

}  // namespace

std::unique_ptr<Peer> make_iceoryx(std::size_t size) {
  static Daemon daemon;
  return std::make_unique<Iceoryx>(size);
}

}  // namespace bench::peers
