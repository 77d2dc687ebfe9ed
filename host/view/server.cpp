#include "host/view/server.h"

#include <httplib.h>
#include <sys/socket.h>

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "host/view/address_check.h"

namespace impactdic::view {
namespace {

constexpr std::size_t kLongestPath = 200;
constexpr int kThreads = 16;  // a browser keeps six connections, a second one of them as many

// No script but the page's own files, and nothing from elsewhere. Plotly sets styles of its own.
constexpr char kPolicy[] =
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'";

httplib::Headers headers() {
  return {{"Content-Security-Policy", kPolicy},
          {"X-Content-Type-Options", "nosniff"},
          {"X-Frame-Options", "DENY"},
          {"Referrer-Policy", "no-referrer"},
          {"Cross-Origin-Resource-Policy", "same-origin"},
          {"Cross-Origin-Opener-Policy", "same-origin"},
          {"Cache-Control", "no-store"}};
}

PageAnswer refusal(int status, const std::string& line) {
  // Text of a file that is no UTF-8 must not end the answer.
  return {status, "application/json",
          nlohmann::json{{"error", line}}.dump(-1, ' ', false,
                                               nlohmann::json::error_handler_t::replace)};
}

PageAnswer ask(const Answer& answer, const PageRequest& request) {
  try {
    return answer(request);
  } catch (const NotThere& error) {
    return refusal(404, error.line());
  } catch (const Overtaken& error) {
    return refusal(409, error.line());
  } catch (const InvalidArgument& error) {
    return refusal(400, error.line());
  } catch (const Error& error) {
    return refusal(500, error.line());
  } catch (const std::exception& error) {
    return refusal(500, error.what());
  }
}

void send(PageAnswer answer, httplib::Response& response) {
  response.status = answer.status;
  if (answer.gzipped) response.set_header("Content-Encoding", "gzip");
  if (answer.body.empty()) return;
  // Handed out in pieces, since the library would press a whole body with Brotli at its highest
  // quality, the packed script once more: seconds of work for what never leaves this machine.
  const auto body = std::make_shared<const std::string>(std::move(answer.body));
  response.set_content_provider(
      body->size(), answer.type,
      [body](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
        return sink.write(body->data() + offset, length);
      });
}

}  // namespace

struct Server::Impl {
  Answer answer;
  std::string token = random_token();
  std::string address;
  httplib::Server http;

  // 0 where the request may be answered, else the status that refuses it.
  int refused(const httplib::Request& request) const {
    if (request.get_header_value_count("Host") != 1 ||
        !is_own_host(request.get_header_value("Host"))) {
      return 403;
    }
    if (request.has_header("Origin") && !is_own_origin(request.get_header_value("Origin"))) {
      return 403;
    }
    if (!behind_token(request.path, token)) return 403;
    if (request.method != "GET" && request.method != "POST") return 405;
    if (request.path.size() > kLongestPath) return 404;
    if (!request.ranges.empty() || request.has_header("Content-Encoding")) return 400;
    return 0;
  }

  void respond(const httplib::Request& request, httplib::Response& response) const {
    PageRequest asked;
    asked.changes = request.method == "POST";
    asked.name = behind_token(request.path, token).value_or("");
    for (const auto& [key, value] : request.params) asked.query.emplace(key, value);
    asked.body = request.body;
    send(ask(answer, asked), response);
  }

  void set_up() {
    using Done = httplib::Server::HandlerResponse;
    http.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
    // Without SO_REUSEPORT, which the library sets: no other program may share the port.
    http.set_socket_options([](socket_t socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    http.set_default_headers(headers());
    http.set_payload_max_length(kLargestBody);
    http.set_keep_alive_max_count(100000);
    http.set_tcp_nodelay(true);
    // Before the body is read. A GET is answered here: its path meets no pattern.
    http.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& out) {
      if (const int status = refused(request)) {
        send({status, "text/plain; charset=utf-8", "refused\n"}, out);
        return Done::Handled;
      }
      if (request.method == "POST") return Done::Unhandled;
      respond(request, out);
      return Done::Handled;
    });
    http.Post("/.*", [this](const httplib::Request& request, httplib::Response& out) {
      respond(request, out);
    });
  }
};

Server::Server(int port, Answer answer) : impl_(std::make_unique<Impl>()) {
  impl_->answer = std::move(answer);
  impl_->set_up();
  if (port == 0) {
    port = impl_->http.bind_to_any_port("127.0.0.1");
  } else if (!impl_->http.bind_to_port("127.0.0.1", port)) {
    port = -1;
  }
  if (port < 0) throw FileError("the port cannot be had", "--port", "is it taken?");
  impl_->address = "http://127.0.0.1:" + std::to_string(port) + "/" + impl_->token + "/";
}

Server::~Server() = default;

const std::string& Server::address() const { return impl_->address; }

void Server::serve(const std::function<bool()>& stopped) {
  std::thread listening([this] { impl_->http.listen_after_bind(); });
  while (!impl_->http.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  while (!stopped()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  impl_->http.stop();
  listening.join();
}

}  // namespace impactdic::view
