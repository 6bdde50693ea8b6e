// SPDX-License-Identifier: LGPL-3.0-or-later
/// Cyclone DDS within one process, best effort, the newest value kept. The library hands the
/// serialized value to the reader inside dds_write(), without the network.
#include <cstring>

#include <dds/dds.h>

#include "bench/peers/peer.h"
#include "block.h"

namespace bench::peers {
namespace {

constexpr dds_domainid_t kDomain = 117;
constexpr const char* kLoopback =
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address=\"127.0.0.1\"/>"
    "</Interfaces><AllowMulticast>false</AllowMulticast></General></Domain></CycloneDDS>";

class Cyclone : public Peer {
 public:
  explicit Cyclone(std::size_t size) : size_(size) {
    domain_ = dds_create_domain(kDomain, kLoopback);
    participant_ = dds_create_participant(kDomain, nullptr, nullptr);
    const dds_entity_t topic =
        dds_create_topic(participant_, &MauvePeersBlock_desc, "mauve_peers", nullptr, nullptr);
    dds_qos_t* qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
    writer_ = dds_create_writer(participant_, topic, qos, nullptr);
    reader_ = dds_create_reader(participant_, topic, qos, nullptr);
    dds_delete_qos(qos);
  }
  ~Cyclone() override {
    dds_delete(participant_);
    dds_delete(domain_);
  }

  [[nodiscard]] bool connected() const {
    for (int tries = 0; writer_ > 0 && reader_ > 0 && tries < 200; ++tries) {
      dds_publication_matched_status_t matched;
      if (dds_get_publication_matched_status(writer_, &matched) == DDS_RETCODE_OK &&
          matched.current_count > 0) {
        return true;
      }
      dds_sleepfor(DDS_MSECS(10));
    }
    return false;
  }
  void write(const void* data) override {
    MauvePeersBlock block{};
    block.bytes._length = block.bytes._maximum = static_cast<std::uint32_t>(size_);
    block.bytes._buffer = static_cast<std::uint8_t*>(const_cast<void*>(data));
    dds_write(writer_, &block);
  }
  void read(void* into) override {
    void* loaned = nullptr;
    dds_sample_info_t info;
    const dds_return_t count = dds_take(reader_, &loaned, &info, 1, 1);
    if (count <= 0) return;
    const auto* block = static_cast<const MauvePeersBlock*>(loaned);
    if (info.valid_data && block->bytes._length == size_) {
      std::memcpy(into, block->bytes._buffer, size_);
    }
    dds_return_loan(reader_, &loaned, count);
  }

 private:
  std::size_t size_;
  dds_entity_t domain_ = 0;
  dds_entity_t participant_ = 0;
  dds_entity_t writer_ = 0;
  dds_entity_t reader_ = 0;
};

}  // namespace

std::unique_ptr<Peer> make_cyclone(std::size_t size) {
  auto peer = std::make_unique<Cyclone>(size);
  return peer->connected() ? std::move(peer) : nullptr;
}

}  // namespace bench::peers
