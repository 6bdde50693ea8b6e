// SPDX-License-Identifier: LGPL-3.0-or-later
#include "server/session.h"

#include <poll.h>
#include <sys/ioctl.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>

namespace mauve::server {

namespace asio = boost::asio;
using protocol::Json;

namespace {

/// So much of one client is served at once; a stop of any client waits for it.
constexpr int kLinesAtOnce = 8;
constexpr std::size_t kLongLine = 16 * 1024;

}  // namespace

Session::Session(Socket socket, Caller caller, SessionContext& context)
    : socket_(std::move(socket)),
      caller_(std::move(caller)),
      context_(context),
      framer_(context.limits.line),
      since_(Clock::now()),
      partial_since_(since_),
      progress_(since_) {}

void Session::start() {
  // Producers know the outbox, the outbox knows this session weakly: no object keeps a dead client.
  auto wake = [weak = weak_from_this(), executor = socket_.get_executor()] {
    asio::post(executor, [weak] {
      if (const auto self = weak.lock()) {
        self->write();
      }
    });
  };
  caller_.outbox = std::make_shared<Outbox>(context_.limits.unsent_soft,
                                            context_.limits.subscriptions, std::move(wake));
  auto params = context_.dispatcher.hello();
  params["role"] = to_string(caller_.role);
  params["limits"] = {{"line", context_.limits.line},
                      {"depth", protocol::kMaxDepth},
                      {"inflight", context_.limits.in_flight}};
  if (caller_.only_urgent()) {
    for (const auto& method : protocol::methods()) {
      if (method.when_full()) {
        params["limits"]["only"].push_back(method.name);
      }
    }
    params["limits"]["since"] = caller_.only_urgent_since;
  }
  answer(protocol::make_notification("hello", std::move(params)));
  read();
}

void Session::end(const std::string& reason) {
  if (std::exchange(ended_, true)) {
    return;
  }
  boost::system::error_code ignored;
  socket_.close(ignored);
  caller_.outbox->shut();
  context_.dispatcher.gone(caller_.client);
  context_.on_end(caller_.client, reason);
}

void Session::displace(const Error& why) {
  if (!ended_ && sending_.empty()) {  // else the line would stand in the middle of another one
    const auto line =
        protocol::to_line(protocol::make_error(nullptr, protocol::fault_of(why))) + '\n';
    boost::system::error_code ignored;
    socket_.non_blocking(true, ignored);
    socket_.send(asio::buffer(line), 0, ignored);
  }
  end(why.message);
}

bool Session::idle() {
  int unread = 0;  // a request that [io] has not come to yet
  return answered_ && in_flight_ == 0 && !waits_ && !framer_.partial() && out_bytes_ == 0 &&
         ioctl(socket_.native_handle(), FIONREAD, &unread) == 0 && unread == 0;
}

void Session::finish() {
  input_ended_ = true;
  leaving_ = true;
  end_if_done();
}

void Session::read() {
  if (ended_ || reading_ || input_ended_ || has_enough()) {
    return;
  }
  reading_ = true;
  socket_.async_read_some(asio::buffer(buffer_),
                          [self = shared_from_this()](const auto& error, std::size_t size) {
                            self->on_read(error, size);
                          });
}

void Session::on_read(const boost::system::error_code& error, std::size_t size) {
  reading_ = false;
  if (ended_) {
    return;
  }
  if (error) {
    input_ended_ = true;
    if (error != asio::error::eof) {
      return end(error.message());
    }
    // The end of the input ends the last line as well.
    static_cast<void>(!framer_.partial() || framer_.feed("\n"));
    return serve_lines();
  }
  const bool was_partial = framer_.partial();
  const auto now = Clock::now();
  heard_ = true;
  since_ = now;
  if (!framer_.feed({buffer_.data(), size})) {
    input_ended_ = true;
    overlong_ = true;
  }
  if (!was_partial) {
    partial_since_ = now;
  }
  serve_lines();
}

void Session::serve_lines() {
  for (int served = 0; !ended_ && !has_enough(); ++served) {
    auto line = framer_.next();
    if (!line) {
      break;
    }
    // The next line, if there is one, has a time limit of its own that begins now.
    partial_since_ = Clock::now();
    if (served == kLinesAtOnce || line->size() > kLongLine) {
      return serve_in_turn(*std::move(line));
    }
    serve(*line);
  }
  read();
  end_if_done();
}

void Session::serve_in_turn(std::string line) {
  waits_ = true;
  context_.turns.take([self = shared_from_this(), line = std::move(line)] {
    self->waits_ = false;
    if (!self->ended_) {
      self->serve(line);
      self->serve_lines();
    }
  });
}

void Session::serve(const std::string& line) {
  auto parsed = protocol::parse_request(line);
  if (auto* refusal = std::get_if<protocol::Refusal>(&parsed)) {
    return answer(protocol::make_error(std::move(refusal->id), refusal->fault));
  }
  dispatch(std::get<protocol::Request>(std::move(parsed)));
}

void Session::dispatch(protocol::Request request) {
  const auto* method = protocol::find_method(request.method);
  if (method == nullptr) {
    return answer(protocol::make_error(request.id, protocol::unknown_method(request.method)));
  }
  if (caller_.only_urgent() && !method->when_full()) {
    const auto fault = protocol::fault_of(
        refuse({Errc::limit, "too_many_clients"}, "uid " + std::to_string(caller_.peer.uid),
               std::string(caller_.only_urgent_since) +
                   ", so this connection may only stop, confirm and undo",
               "close other connections; mauvectl list clients"));
    return turn_down(*method, std::move(request), fault);
  }
  // Stopping is never refused for having been asked too often.
  if (method->mutation() && !method->out_of_band() &&
      !context_.rate.allow(caller_.peer.uid, Clock::now())) {
    const auto fault = protocol::fault_of(refuse({Errc::limit, "too_many_requests"}, request.method,
                                                 "too many changes a second from this user",
                                                 "put several values into one param.set"));
    return turn_down(*method, std::move(request), fault);
  }
  // After the limits: checking arguments is work too.
  if (const auto fault = protocol::check_params(*method, request.params)) {
    return turn_down(*method, std::move(request), *fault);
  }
  ++in_flight_;
  auto reply = [weak = weak_from_this(), executor = socket_.get_executor(),
                id = request.id](Outcome outcome) {
    // Here, and not on [io], through which each stop comes.
    auto* fault = std::get_if<protocol::Fault>(&outcome);
    auto line = protocol::to_line(
        fault != nullptr ? protocol::make_error(id, *fault)
                         : protocol::make_response(id, std::get<Json>(std::move(outcome))));
    asio::post(executor, [weak, line = std::move(line)]() mutable {
      const auto self = weak.lock();
      if (!self || self->ended_) {
        return;
      }
      --self->in_flight_;
      self->since_ = Clock::now();
      self->queue(std::move(line));
      self->serve_lines();
    });
  };
  context_.dispatcher.dispatch(caller_, *method, std::move(request), std::move(reply));
}

void Session::turn_down(const protocol::Method& method, protocol::Request request,
                        const protocol::Fault& fault) {
  answer(protocol::make_error(request.id, fault));
  if (method.mutation()) {
    context_.dispatcher.refused(caller_, method, std::move(request), fault);
  }
}

void Session::answer(const Json& message) { queue(protocol::to_line(message)); }

void Session::queue(std::string line) {
  if (ended_) {
    return;
  }
  if (unsent() >= context_.limits.unsent_hard) {
    return end("too much unread");
  }
  answered_ = heard_;
  out_.push_back(std::move(line) + '\n');
  out_bytes_ += out_.back().size();
  write();
}

void Session::write() {
  if (ended_ || !sending_.empty()) {
    return;
  }
  if (!out_.empty()) {
    sending_ = std::move(out_.front());
    out_.pop_front();
  } else if (auto line = caller_.outbox->take()) {
    sending_ = std::move(*line);
    out_bytes_ += sending_.size();
  } else {
    return end_if_done();
  }
  sent_ = 0;
  if (out_bytes_ == sending_.size()) {
    progress_ = Clock::now();  // nothing was on its way: patience begins now
  }
  send();
}

void Session::send() {
  socket_.async_write_some(asio::buffer(sending_) + sent_,
                           [self = shared_from_this()](const auto& error, std::size_t size) {
                             self->on_sent(error, size);
                           });
}

void Session::on_sent(const boost::system::error_code& error, std::size_t size) {
  if (ended_) {
    return;
  }
  if (error) {
    return end(error.message());
  }
  progress_ = Clock::now();
  sent_ += size;
  out_bytes_ -= size;
  if (sent_ < sending_.size()) {
    return send();
  }
  sending_.clear();
  write();
  serve_lines();
}

void Session::end_if_done() {
  if (ended_ || !input_ended_ || waits_ || in_flight_ > 0 || out_bytes_ > 0) {
    return;
  }
  if (std::exchange(overlong_, false)) {
    return answer(protocol::make_error(
        nullptr, protocol::fault_of(protocol::kParseError, "the line is longer than 1 MiB", {},
                                    "the connection is closed")));
  }
  // A half-closed client with a subscription still listens.
  if (leaving_ || caller_.outbox->subscriptions() == 0) {
    end("closed");
  }
}

void Session::check_patience(Clock::time_point now) {
  if (const auto reason = impatience(now); !reason.empty()) {
    end(reason);
  } else if (input_ended_ && hung_up()) {
    end("closed");
  }
}

std::string Session::impatience(Clock::time_point now) const {
  const auto& limits = context_.limits;
  if (!heard_ && !input_ended_ && now - since_ >= limits.first_byte) {
    return "silent from the start";
  }
  if (framer_.partial() && in_flight_ < limits.in_flight && !input_ended_ &&
      now - partial_since_ >= limits.half_request) {
    return "half a request";
  }
  const bool over = unsent() >= limits.unsent_soft;
  if (unsent() > 0 && now - progress_ >= (over ? limits.stalled : limits.idle)) {
    return "does not read";
  }
  const bool idle = in_flight_ == 0 && caller_.outbox->subscriptions() == 0;
  if (idle && unsent() == 0 && now - since_ >= limits.idle) {
    return "idle";
  }
  return {};
}

bool Session::has_enough() const {
  return waits_ || in_flight_ >= context_.limits.in_flight ||
         unsent() >= context_.limits.unsent_soft;
}

std::size_t Session::unsent() const { return out_bytes_ + caller_.outbox->bytes(); }

bool Session::hung_up() {
  pollfd poll_fd{socket_.native_handle(), 0, 0};
  return poll(&poll_fd, 1, 0) > 0 && (poll_fd.revents & (POLLHUP | POLLERR)) != 0;
}

}  // namespace mauve::server
