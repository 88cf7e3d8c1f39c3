#pragma once
/// \file Messages between clients and a session, as docs/viewer-protocol.md has them.

#include <core/check.hpp>
#include <viewer/session/view_session.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

namespace supple {

inline constexpr int protocol_version = 1;
inline constexpr std::size_t largest_message = std::size_t{1} << 20;  ///< [bytes]

/// What moved, in frames for one client.
enum class StreamKind : std::uint32_t { Coordinates = 1, Positions = 2 };
template <>
inline constexpr std::array names_of<StreamKind>{Named{StreamKind::Coordinates, "coordinates"},
                                                 Named{StreamKind::Positions, "positions"}};

namespace message {
struct Ack {
  std::uint32_t frame = 0;
};
struct Stream {
  StreamKind what = StreamKind::Coordinates;
};
struct Save {};
}  // namespace message

/// What a client says: to its server alone, or to the session.
using Message = std::variant<message::Ack, message::Stream, message::Save, Request>;

/// A message that is understood and not followed.
struct Refusal : InputError {
  std::string what_to_do;  ///< its "do", if it had one
  Refusal(std::string action, const std::string& reason) : InputError(reason), what_to_do(std::move(action)) {}
};
/// Bytes that are no message at all.
struct NoMessage : InputError {
  using InputError::InputError;
};

/// A message and its "do".
struct ReadMessage {
  std::string what_to_do;
  Message message;
};
/// \throws Refusal for what is JSON and no message of these; NoMessage for what is no JSON or larger than largest_message.
ReadMessage read_message(std::string_view text, const ViewModel& model);

std::string hello_text(int client, Index num_clients);
std::string ready_text();
std::string progress_text(std::string_view stage, double share);
std::string refused_text(std::string_view action, std::string_view reason);
std::string warning_text(std::string_view text);
std::string saved_text(const EditScene& scene, const NodePlaces& places);
std::string state_text(const ViewSession& session);

/// A frame as it is sent. \param number  of the frame.
std::string frame_bytes(const ViewFrame& frame, std::uint32_t number, StreamKind what, const ViewGeometry& geometry);

}  // namespace supple
