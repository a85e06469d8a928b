"""The vital output's contract: what happens in which tick of one channel.

Gateware and model are written from this page and from requirements DRV-1 … DRV-18, not from one
another. Ref: source 004, paragraphs 9 to 30. Numbers named here are Config's; enumerations are
those of `states`, frames and messages those of `frame`.

**Ticks.** A tick is one period of the channel's clock; `x[k]` is what x holds during tick k. Tick 0
is the first after reset (`rst` is 1 in tick k: tick k + 1 is a new tick 0 and all is as at start).
A *register* changes in the tick after that whose event changes it; all registers read in tick k
are as in tick k, also where another event of tick k changes them for k + 1. All start at 0 unless
told otherwise. An *event* happens in one tick. Sums are modulo the width; where one number is
*ahead* of another, or a *step* between them is told, it is their difference modulo 2³², taken as
signed. All outputs are registers.

**Time (DRV-3).** `index` and `phase` are the channel's own time. In every tick, unless it is
seated, phase grows by 1; but in tick k with phase[k] + c ≥ cycle_ticks - 1, c being `pending`[k]
limited to ± slew_ticks, it becomes 0, index grows by 1 and c is taken off pending (the cycle
*ends*). An *update* is a tick with `time.valid` and time.phase < cycle_ticks; by d it is ahead of
the own time of tick k (of index · cycle_ticks + phase, where the step of the indices is -1, 0 or 1;
else it is far). In tick k:
- seated before, not far and |d| ≤ margin_ticks: a *good* update: pending becomes d, less c if the
  cycle ends in k; `consistent` becomes 1, `holdover` 0.
- else, if not seated yet, or life[k] = 0 and the update is ahead (step of the index > 0, or = 0
  and d ≥ 0): it *seats*: phase becomes time.phase + 1 and index time.index, but if time.phase =
  cycle_ticks - 1, 0 and time.index + 1; pending, consistent and holdover become 0, and no cycle
  ends in k.
- else TIME_JUMP: consistent becomes 0. So time never steps back.
holdover grows by 1 at the end of a cycle, up to holdover_cycles at most (a good update of the same
tick wins). `trusted[k]`: consistent[k] and holdover[k] < holdover_cycles. The status output
`trusted` is this one tick later.

**A frame's check (DRV-2).** It is of some bytes for a board, begun in tick k with the time of tick
k, and has its verdict in tick k + check_ticks. Tried are both boards' IDs with the indices
index[k] - delay_cycles … index[k] + 1. At most one of them gives the frame's CRC. Acceptable with
a `late` margin are: index[k]; index[k] - 1 if phase[k] < late; index[k] + 1 if phase[k] ≥
cycle_ticks - margin_ticks. The verdict is the first that applies: FORMAT (see below); TIME, if not
trusted[k]; if the right board's ID gives the CRC with an acceptable index: good, with this index,
but COMPARATOR if the right board's mask number (index mod 32) in its place gives it too; DELAY, if
it does with another index; MASQUERADE, if the other board's ID does with any of them; CORRUPTION.

**Command (DRV-1, DRV-5).** A byte is transferred in a tick with `command.valid` and
`command.ready`. One with `first` begins a frame, one with `last` ends it in this tick k. The frame
is of the bytes from the last `first` on; it is FORMAT where there has been no `first` since the
frame before, where more than one came since then, where it has not frame_bytes bytes, or where bits
of image or acknowledge beyond the outputs are set. Its check, with late = margin_ticks, begins in
k; in the ticks k + 1 … k + check_ticks - 1 `ready` is 0, else 1 (it is the only output that starts
at 1). In tick V = k + check_ticks the verdict is told. Good: let step be from `reference` to the
frame's sequence number; it is *accepted* if `referenced` and step = 1, or referenced, life > 0 and
1 ≤ step ≤ life_cycles. Else not referenced: START; step = 0: REPETITION; step < 0: RESEQUENCE; else
INSERTION. Accepted, or good with life = 0: reference becomes its sequence number, referenced 1.
Accepted: step - 1 frames are lost. The frame becomes `own` (sequence, image, acknowledge, crc,
index of the check), `carries` 1. In the tick in which life becomes 0 referenced becomes 0 (in the
same tick k as a verdict: the verdict's change is the later one, it wins). FORMAT to INSERTION, but
not TIME, which tells nothing of the frame, are *rejections*.

**Cross-link, sending (DRV-6).** Message m = 0, 1, … begins in tick S = 8 + m · link_period_ticks:
`link_tx` is 0 for bit_ticks, then each of its bits, the most significant one first, for bit_ticks,
else 1 (`link_tx` starts at 1). The fields hold what their registers hold in tick S - 2: number m;
`boot`, the input, sampled in tick 0; the own digest; test_phase; codes; carries, passed, and own's
fields.

**Cross-link, receiving.** `link_rx` passes the synchroniser and filter that all inputs pass
(primitives.FilteredInput, link_filter_ticks). While none is received, a falling edge in tick F
begins a message; its bit j = 0, 1, … is sampled in tick F + j · bit_ticks + ⌊bit_ticks / 2⌋. Is bit
0 a 1, LINK_CHECK in that tick and none is received from the next on. After the sample of the last
bit, in tick R - 1, its verdict is told in tick R, from which on the next may begin. In tick R, the
first that applies, step being from `number` to the message's, modulo 256:
- wrong CRC: LINK_CHECK.
- another digest than the own: LINK_DIGEST.
- linked, step not in 1 … 3: LINK_SEQUENCE.
- not linked, and either not numbered or step not 1: number becomes the message's, numbered 1.
- it is *taken*: linked becomes 1, number the message's, numbered 1, and its fields `peer`'s.
`silence` becomes 0 in the tick after one is taken, else it grows by 1; in a tick with linked and
silence = lost_ticks - 1, and none taken: LINK_LOST, linked and numbered become 0.
*Boot*: taken, and linked before at any time, with another boot number than peer's. (After a loss
peer's fields stay as they are.)

**Oscillator (DRV-17).** While linked, `offset` grows by 1 each tick. In a tick in which a message
is taken: not linked before: offset and `window` become 0. Else let off = offset + 1 - step ·
link_period_ticks. |off| > drift_limit_ticks: OSCILLATOR, drifting becomes 1, offset and window 0.
Else window + step ≥ window_messages: drifting, offset and window become 0. Else offset becomes off,
window grows by step. `peer_ok`[k]: linked[k] and not drifting[k]. peer_code[i]: peer's code if
peer_ok, else OFF.

**Forwarded frame (DRV-6).** A message taken in tick R with `carries`, whose sequence is not
`seen`, or before which nothing has been seen since reset or since the last boot (a boot of this
tick R too): seen becomes its sequence, and the frame made of its sequence, image, acknowledge and
frame_crc is checked for the peer's board, with late = margin_ticks + latency_ticks, begun in R with
R's time. In tick R + check_ticks: good: it is *peer-accepted*; else FORWARD.

**Vote (DRV-6).** own and `forwarded` are slots, `own_there` and `forwarded_there` whether they wait
for a vote. In tick k, in this order, each as if the one before had been done:
1. own_there[k] and forwarded_there[k]: if index, sequence, image and acknowledge are the same, it
   *passes*: passed and `open` become 1; else MISMATCH. Both there become 0, `remaining` 0.
2. else remaining[k] = 1: if own_there[k] or forwarded_there[k]: SKEW, both become 0. remaining
   becomes 0.
3. else remaining[k] > 1: it falls by 1.
4. accepted or peer-accepted in k: its slot is filled, its there becomes 1; accepted makes passed
   and open 0. If remaining is 0 after 1 to 3, it becomes tau0_ticks.
open[k], peer_ok[k], peer.passed[k], peer.carries[k], peer.sequence[k] = own.sequence[k]: own is
*stored* in k: image, acknowledge, `stored_index` and life = life_cycles are its; open becomes 0
(unless 1 makes it 1 for another frame, which cannot be).

**Life (DRV-7).** In a tick with phase[k] = decision_ticks the cycle index[k] - 1 is decided: unless
one is stored in k or stored_index is not behind index[k] - 1: if life > 0, it falls by 1; if it
becomes 0: LIFE_OUT, image becomes 0. Whether stored or not, and also where it passes in k, open
becomes 0 if own.index is not ahead of index[k] - 1. With zero_at_once, where a frame is accepted or
peer-accepted in k, image keeps only the bits that the frame has too (after all else in k).

**Errors (DRV-15)**, with error_interval_cycles > 0. A rejection in k: if `errors_remaining`[k] > 0,
latched becomes 1, with LATCHED if it was 0; errors_remaining becomes error_interval_cycles.
Else, in a tick of decision, it falls by 1 to 0 at the lowest. From the tick in which latched is
1 on, as long as it is, image is 0.

**Acknowledgement (DRV-12).** Stored in k: rises are the bits of the stored acknowledge that are 0
in `acknowledge`[k] (which starts as all ones): these outputs are *acknowledged* in k. If there is
any, latched, first_cause and first_output become 0 before all else of tick k that changes them: a
cause of the same tick is the first, a rejection of it may latch anew.

**Start (boot number, DRV-5).** `blocked` starts as all ones; boot makes it so again. Else a bit is
cleared in k if life[k] > 0 and image[k] has it 0.

**Test of the shut-off paths (DRV-18).** FPGA 1 leads. *Quiet*: each output is IDLE or in an alarm.
done: test_phase is DONE or REQUESTED; peer_done: peer's is. In tick k, the first that applies:
- WANTED, quiet, peer_ok, and the peer is WANTED (in FPGA 2: peer_done): the test *begins*, RUNNING.
- RUNNING, no output is TEST or WAIT: DONE.
- FPGA 1, done, boot: WANTED. FPGA 2, done, peer_ok, the peer is WANTED or RUNNING: WANTED.
- FPGA 1, REQUESTED, quiet, image = 0: WANTED.
- DONE, the input `test`, or in FPGA 1 peer_ok and the peer is REQUESTED: REQUESTED.
`watching`: peer_ok, and the peer is RUNNING. cmd[i]: image[i], not blocked[i], done and peer_done.

**Feedback.** Each `pulse_feedback` and `contact` passes a FilteredInput. since, which starts at
zero_ticks, becomes 1 after the tick of a rise, else it grows by 1 up to zero_ticks. `frequency`
becomes 1 after a rise with period_low_ticks ≤ since ≤ period_high_ticks, 0 after any other rise and
after a tick without one in which since ≥ period_high_ticks. fb[i]: contact's level is 1, or since <
zero_ticks.

**Drive (DRV-8 … DRV-12).** Of each output, in tick k, the first that applies. `elapsed` is 0 in the
first tick of a state and grows by 1, saturating above all limits that it is held to. FPGAs that see
nothing wrong stay.
- IDLE: watching and fb: FEEDBACK_ALARM. fb: WAIT, with `left` 0. The test begins: TEST. cmd:
  PRE_DRIVE.
- PRE_DRIVE: not cmd: IDLE. fb: WAIT, left 0. peer_code PRE_DRIVE or DRIVE: DRIVE. elapsed ≥
  tau1_ticks - 1: HANDSHAKE_ALARM.
- DRIVE: not cmd: WAIT, left 0. peer_code ALARM: HANDSHAKE_ALARM. OFF: WAIT, left 1. PRE_DRIVE and
  elapsed ≥ not_yet_driving_ticks: HANDSHAKE_ALARM. elapsed ≥ pulse_grace_ticks and not frequency:
  FEEDBACK_ALARM. elapsed ≥ pick_up_ticks and contact 0: FEEDBACK_ALARM.
- WAIT: left, cmd and elapsed ≥ skew_ticks: HANDSHAKE_ALARM. not fb, and not (left and cmd): IDLE.
  fb and elapsed ≥ release_ticks: FEEDBACK_ALARM. In a tick without cmd left becomes 0.
- TEST: contact 1: FEEDBACK_ALARM. elapsed ≥ test_ticks - 1: WAIT, left 0, if frequency, else
  FEEDBACK_ALARM.
- HANDSHAKE_ALARM: not cmd and not fb: IDLE.
- FEEDBACK_ALARM: acknowledged in k, not cmd and not fb: IDLE.
`pulses`[i] is 1 in tick k + 1 if in k the state is DRIVE or TEST and elapsed[k], modulo
period_ticks, is below half_period_ticks (counted through, beyond where elapsed saturates).

**Status.** The output of a field is the register of that name; `states` and `test_phase` are the
states above; `sequence` is own's. Counters: accepted, START, lost frames, passed, stored, and each
cause, of an output's alarms one for each tick in which any output enters it. first_cause, if NONE
and there are causes in k, becomes the lowest of them; first_output the lowest output that enters
this alarm in k, else 0.

**Hardening.** States are held in codes at a distance of at least 3, counters that bound a danger
(life, remaining, elapsed, errors) and the image twice, once inverted. UPSET: a code that is none,
or two that differ: the output's state becomes FEEDBACK_ALARM, of the shared ones life and image
become 0, in the next tick, and while it lasts no pulse is made. A model has no upsets.
"""

from railgate.vital_output.spec.config import Config
from railgate.vital_output.spec.frame import Layout, mask, pack, unpack
from railgate.vital_output.spec.states import CAUSES, Cause, Code, State, TestPhase

__all__ = [
    "CAUSES",
    "Cause",
    "Code",
    "Config",
    "Layout",
    "State",
    "TestPhase",
    "mask",
    "pack",
    "unpack",
]
