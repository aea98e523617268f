"""Parts of a scenario besides its users: services and the telephone, as a table."""

from __future__ import annotations

from prima.sim.vocabulary.happenings import AFTER

SERVED = f"""
service > reply failure | A service that applications send to. Its replies are given in order; the
    last repeats. One without replies accepts messages and does not answer.
  name*: id | its name
  uri: text | an http(s) URI: it answers fetches from there or below
  application: id | the only application that may use it; by default all may
reply > data | An answer.
  {AFTER}
  src: path | the file that answers a fetch of a VoiceXML document; without one, the answer is XML
    of its data
failure | An error instead of an answer.
  {AFTER}
  reason: text = the service does not answer | why
  status: integer 100..599 | the HTTP status that answers a fetch
connection > redirect | What VoiceXML applications know of the user's call, as session.connection;
    without it, or an attribute of it, that is undefined.
  remote: text | the URI of the user's telephone
  local: text | the URI that they called
  protocol: text | the protocol's name, such as sip
  version: text | the protocol's version
  aai: text | data passed with the call
  originator: text(local remote) | who has called
redirect | A station that redirected the call, the last one first.
  uri*: text | its URI
  pi: text | the presentation information
  si: text | the screening information
  reason: text | why it was redirected
transfer | How calls go to a destination to which a VoiceXML application transfers the user. Of
    several for a destination each is for one call, in order; the last repeats.
  to: text | the destination's URI, or what it begins with
  outcome: text = far_end_disconnect | how it ends: busy, noanswer or network_busy before anybody
    answers; far_end_disconnect, network_disconnect, near_end_disconnect, maxtime_disconnect or
    unknown after it; or an event whose name begins with error
  after: delay = 0s | how long until it is answered, or fails
  lasts: delay = 10s | how long it lasts once it is answered
"""
