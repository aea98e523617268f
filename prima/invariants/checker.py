"""The checker goes through the records of one run and applies every family of rules."""

from __future__ import annotations

from collections.abc import Callable

from prima.invariants.model import AB, GONE, LINKED, Record, Tree, base, ms
from prima.invariants.starts import Starts
from prima.invariants.table import contradictions


class Checker(Starts):
    """Goes through the records of one run, in order."""

    def run(self) -> list[str]:
        """All violations, in the order in which they show."""
        takes: dict[str, Callable[[Record], None]] = {
            "load": self._load,
            "unload": self._unload,
            "request": self._request,
            "window": self.note_window,
            "leave": self.note_leave,
            "listening": self._listening,
            "stream-end": self.note_stream_end,
            "emergency": self.note_emergency,
            "decision": self._decision,
            "start": self.note_start,
            "end": self._end,
            "starve": self.note_starve,
            "fail": self.note_fail,
            "cancel": self.note_cancel,
            "event": self._event,
            "interrupt": self.note_interrupt,
            "halted": self.note_halted,
            "held": self.note_held,
            "substitute": self.note_substitute,
            "hold": self._hold,
            "floor": self.note_floor,
            "suspend": self.note_suspend,
            "resume": self.note_resume,
            "stop": self.note_stop,
            "over": self.note_over,
        }
        for place, record in enumerate(self.records):
            if record["time"] != self.now:
                self._instant_over()
                self._until(record["time"])
            self.place = place
            self.tells_rightly(record)
            take = takes.get(record["phase"])
            if take is not None:
                take(record)
        self._instant_over()
        return self.found

    def _end(self, record: Record) -> None:
        self.note_answer(record)
        self.note_turn(record)
        self.note_lapse(record)
        self.note_end(record)

    def _until(self, time: int) -> None:
        """Advance to the next recorded instant, past the moment in which K1 may lapse."""
        self.pass_time(time)
        lapse = self.lapses_at
        if self.now < lapse < time and not self.in_view and not self.halted:
            self.now = lapse
            for ab in self.waiting.values():
                if ab.leaves and self.prima:
                    self.late(ab)
        self.now = time
        self._new_instant()

    def _load(self, record: Record) -> None:
        if record["actor"] == "mediator":
            self._former(record["app"])
            self.apps.setdefault(record["app"], len(self.apps))
            self.gone_apps.discard(record["app"])
            self.loaded.add(record["app"])
            self.left = {one for one in self.left if one[0] != record["app"]}  # it is counted anew
            self.asked.pop(record["app"], None)

    def _former(self, name: str) -> None:
        """ABs still running when an application is loaded again belong to its former run (E2)."""
        self.latest.pop(name, None)
        former = f"{name}, unloaded"
        known: list[Tree | AB] = [*self.trees.values(), *self.abs.values()]
        for one in known:
            if one.app == name:
                one.app = former
                self.apps[former] = self.apps[name]
                self.gone_apps.add(former)

    def _unload(self, record: Record) -> None:
        if record["actor"] == "mediator":
            self.left_at_end(record["app"], record.get("outcome") or "")
            self.gone_apps.add(record["app"])
            self.unloaded.add(record["app"])
            self.taken_out.discard(record["app"])
            self.loaded.discard(record["app"])
        elif record["app"] in self.loaded:
            self.taken_out.add(record["app"])

    def _decision(self, record: Record) -> None:
        if self.decision is not None and self.prima:
            self.report(13, "S2", f"{self.decision['winner']} is selected, but does not start")
        self.decision = record
        self.look_for_turn()

    def _event(self, record: Record) -> None:
        self.note_speech(record)
        self.note_event(record)

    def _hold(self, record: Record) -> None:
        self.look_for_turn()
        self.note_hold(record)

    def _listening(self, record: Record) -> None:
        ab = self.running.get(base(record["behavior"]))
        if ab is not None:
            ab.listening = True

    # Requests -----------------------------------------------------------------------

    def _request(self, record: Record) -> None:
        name, app = record["behavior"], record["app"]
        if name in self.abs:
            self.report(3, "U1", f"{name} is requested twice")
            return
        self._may_ask(record)
        self.asks(record)
        new = record["tree"] not in self.trees
        tree = self.trees.setdefault(record["tree"], Tree(record["tree"], app))
        ab = self.abs[name] = self._made(record, tree)
        before = self.abs.get(ab.put_before) if ab.inserted else None
        tree.members[name] = ab
        self.wants_hold(tree, ab, record)
        if ab.unit is not None:
            self._into_unit(ab.unit, record)
        if ab.inserted:
            self.put_in(ab, before, record)
        if ab.parents:
            ab.phase = LINKED
        else:
            self._waits_from_now(ab)
        if record.get("order") == "now":
            self.urgent.append((ab, self.place))
        self._asked_rightly(ab, record, new)
        if record.get("order") == "now":
            self.maybe_silence(ab)
        if ab.unit is None and not ab.inserted:
            self.latest[app] = ab

    def _into_unit(self, unit: AB, record: Record) -> None:
        """U4: the Commands of a group are requested when it starts from its beginning, once."""
        if unit.name in self.groups and any(one["time"] != self.now for one in unit.content):
            self.report(3, "U4", f"{record['behavior']} is requested, but {unit.name} has begun")
        unit.content.append(record)

    def _waits_from_now(self, ab: AB) -> None:
        """C3: requests in a window count as following the AB that has just ended (S2c)."""
        window = self.window_of(ab.app)
        self.wait(ab)
        if window is not None and not ab.inserted:
            ab.followed_at = self.now

    def _asked_rightly(self, ab: AB, record: Record, new: bool) -> None:
        """Check a request: its type's row, its stream, its cause, its unit's devices."""
        for text in [] if ab.inserted else contradictions(record):
            self.report(15, "K2", f"{ab.name} is {ab.command}, but {text}")
        if ab.unit is not None and not ab.devices <= ab.unit.devices:
            more = ", ".join(sorted(ab.devices - ab.unit.devices))
            self.report(15, "U5", f"{ab.name} needs {more}, which {ab.unit.name} does not own")
        if ab.unit is not None and (ab.leaves or ab.feedback):
            self.report(15, "U4", f"{ab.name} is {ab.command} in {ab.unit.name}")
        if not ab.inserted and self.prima:
            self.caused_rightly(ab, record)
        if self.prima:
            self.placed_rightly(ab, new)

    def _may_ask(self, record: Record) -> None:
        """O3, E2, X6: states that were left and applications that have ended make no requests."""
        name, app = record["behavior"], record["app"]
        if (app, record.get("state")) in self.left and record.get("unit") not in self.nested:
            self.report(3, "O3", f"{name} is requested, but its state was left")
        if app in self.gone_apps and not record.get("unit"):
            self.report(3, "E2", f"{name} is requested, but {app} has ended")
        if record["command"] in self.lacking:
            self.report(3, "X6", f"{name} is requested, but the robot lacks {record['command']}")

    def _made(self, record: Record, tree: Tree) -> AB:
        """The AB of a request."""
        cause = record.get("cause") if record.get("reactive") else None
        unit = self.abs.get(base(record["unit"])) if record.get("unit") else None
        return AB(
            name=record["behavior"],
            command=record["command"],
            app=record["app"],
            tree=tree,
            devices=frozenset(record["devices"]),
            high=record["priority"] == "high",
            question=record["command"] == "q-and-a",
            state=record.get("state"),
            unit=unit,
            cause=cause,
            reacted_to=cause,
            parents=self._parents(record),
            requested=self.now,
            place=self.place,
            urgent=record.get("order") == "now",
            motion=record.get("motion") or "" if unit is None else "",
            fresh_until=self.now + ms(record["fresh"]) if record.get("fresh") else None,
            inserted=record.get("inserted") or "",
            put_before=base(record.get("before") or ""),
            leaves=bool(record.get("leaves")),
            engages=bool(record.get("engages")),
            feedback=bool(record.get("feedback")),
            restartable=bool(record.get("restartable")),
            says="speaker" in record["devices"]
            and (record["command"] == "iu" or bool(record.get("text"))),
            spans=bool(record.get("spans")),
            connect=bool(record.get("connect")),
        )

    def _parents(self, record: Record) -> set[str]:
        """U3: the ABs that a request follows and that are still in memory."""
        parents = record.get("parents") or ([record["parent"]] if record.get("parent") else [])
        names = {base(parent) for parent in parents}
        unknown = [parent for parent in names if parent not in self.abs]
        if unknown:
            text = f"{record['behavior']} follows {unknown[0]}, which was never requested"
            self.report(4, "U3", text)
        if record.get("inserted"):
            names.discard(base(record["before"]))  # the loop of it that has ended
        return {one for one in names if one in self.abs and self.abs[one].phase != GONE}

    # The end of an instant ----------------------------------------------------------

    def _instant_over(self) -> None:
        self._look_back()
        self.note_keepers()

    def _look_back(self) -> None:
        self.look_for_turn()
        self.close_trees()
        self.holds_rightly()
        self.interruptions()
        for cut in self.cuts:
            self.justified(cut)
        self.channel_kept_inside()
        self.left_rightly()
        for app in sorted(self.taken_out):
            self.report(13, "E2", f"{app} is taken out, but its end is not recorded")
        self.taken_out.clear()
        if self.prima:
            self._check_records()
        for tree in self.resumed:
            tree.rank = tree.rank if tree.suspended else 0
        if self.halted:
            for ab in self.running.values():
                self.report(2, "E5", f"{ab.shown} runs during the emergency stop")
            return
        for ab in self.waiting.values():
            self.fresh(ab)
            self.waits_rightly(ab)

    def _check_records(self) -> None:
        """Check the mediator's records of a finished instant."""
        if self.decision is not None:
            self.report(13, "S2", f"{self.decision['winner']} is selected, but does not start")
        self.check_floor()
        self.stopped_rightly()
        self.check_ends()
        self.check_windows()
        self.left_waiting()
