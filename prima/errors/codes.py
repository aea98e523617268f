"""What each problem's code means, for ``prima explain CODE``."""

from __future__ import annotations

CODES: dict[str, str] = {
    "not-xml": "The file is not well-formed XML: a tag is not closed, a quote is missing, or it is"
    " no XML at all. The place says where reading stopped; the mistake is there or before.",
    "encoding": "Documents are read as UTF-8, UTF-16, ASCII, ISO-8859, Windows-125x, KOI8,"
    " Shift_JIS, EUC-JP, ISO-2022-JP, GB 2312, GBK, GB 18030, Big5 or EUC-KR. Save the file as UTF-8,"
    " which needs no declaration.",
    "too-large": "Files are read up to a limit on bytes, elements and attributes, so that nobody's"
    " file can exhaust the machine.",
    "too-deep": "Elements may be nested to a limit. Divide the document into smaller parts.",
    "doctype": "A DOCTYPE may name an external identifier, which is never fetched, but declare"
    " nothing itself: declarations are how XML is made to eat memory.",
    "entity": "Documents declare no entities. Only &amp; &lt; &gt; &quot; &apos; and character"
    " numbers are known.",
    "wrong-root": "The namespace is right but the root element is another one.",
    "wrong-namespace": "The namespace tells what kind of document it is. An application begins with"
    ' <prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="...">.',
    "no-namespace": "A VoiceXML document whose elements are in no namespace is read as if they were in"
    " VoiceXML's. Others may take it for no VoiceXML at all.",
    "unknown-element": "The language has no such element. Nothing in a document is silently ignored.",
    "misplaced-element": "The element exists, but not where it stands; the message says where it may.",
    "stray-text": "Text stands where the language has no place for it. What the robot is to say"
    " stands in <speak> or another Command that speaks.",
    "unknown-attribute": "The element has no such attribute. Nothing is silently ignored.",
    "missing-attribute": "The element needs an attribute that is not there, or one of several.",
    "missing-element": "The element needs a child that is not there.",
    "bad-value": "An attribute's text is not of the attribute's kind: a time has its unit (2s,"
    " 500ms), a number is written in digits, and so on.",
    "out-of-range": "A number is greater or smaller than the attribute or argument allows.",
    "exclusive": "Two attributes exclude each other: they say one thing in different ways, or two"
    " things of which an element does one. Keep one.",
    "duplicate-id": "Two things have one id, so that nobody could tell which is meant.",
    "duplicate-name": "Two items of a form have one name: they would share their variable. Or two"
    " services of a scenario: nobody could tell which one is asked.",
    "duplicate-element": "The element may be there only once.",
    "duplicate-answer": "Two options of a field say the same, folded for case and punctuation.",
    "no-form": "An application is made of forms, its states; it begins with the first.",
    "no-such-form": "A goto, subdialog or link names a form that is not there.",
    "no-such-item": "A name is used that no item of the form has.",
    "no-such-rule": "A grammar names a rule that it does not have; or a tag names one to which its"
    " own rule does not refer.",
    "no-such-name": "A scenario, world or application names a place, thing, gesture, sensor, device or"
    " application that the world, robot or scenario does not have.",
    "no-such-argument": "A Command is given an argument that the robot's profile does not name.",
    "too-long": "One utterance, or one question, keeps the speaker for ten minutes at most, counted at 50 ms a"
    " letter: nobody can answer the user meanwhile, as no unit is cut. A run refuses it as error.semantic"
    " (rule E3).",
    "other-kind": "A document says that it is an FA, the scenario, the command line or the world that it"
    " is an EA, or the other way round. These decide: no document makes itself the robot's own.",
    "no-such-file": "A scenario or a grammar names a file that cannot be read. Paths are relative to"
    " the folder of the document that names them.",
    "no-answer": "A field without options, grammar or type takes no answer: the user could never"
    " leave it. In VoiceXML grammars of its form, links and document-wide grammars count as well; where"
    " none listens, it is error.semantic at run time.",
    "empty-answer": "An option or a grammar that holds nothing to say can never be said.",
    "nothing-to-say": "A Command that speaks has no text.",
    "empty": "The element holds nothing.",
    "after-else": "Nothing but content may stand after <else>: it takes all that is left.",
    "unreachable": "No goto, link or subdialog leads to the form, so its content never runs. Or no way of"
    " a world leads to a place: the robot gets there only from where it sees it.",
    "blocked-way": "A way of a world goes through a wall: the robot that takes it stands before the wall."
    " Given a scenario, also a way that is too near to a wall for its robot, which is blocked by it.",
    "dead-end": "Nothing in the form, its handlers included but for those of errors, is a goto, exit, return, throw or link,"
    " and no subdialog that it calls can exit: once in it, the application waits for ever. That may"
    " be meant; if it is over there, say so with <exit/>, or in a subdialog with <return/>.",
    "dead-content": "What stands behind a goto, return or exit is never reached.",
    "undeclared-variable": "An expression uses, or an assign changes, a variable that no <var>,"
    " form item, <foreach> or <script> declares. At run time that is error.semantic. So is, in VoiceXML, a"
    " param of a subdialog that no <var> of the called form takes, a variable of one <block> in another,"
    " one that is declared only afterwards, and a member of document or another scope that is given a"
    " value, or asked for a member of its own, and that nothing declares there. A grammar's tag uses a name that no"
    " tag of the grammar declares: at run time such an answer is no match.",
    "bad-expression": "An expression or script is not ECMAScript. The place is where its compiler"
    " stopped.",
    "assigning-condition": "A condition has = where a comparison, ==, was most likely meant: it changes the"
    " variable, and holds whenever the new value does.",
    "literal-value": "A text holds a variable's name in braces, as other languages write a value. It is"
    ' said as it stands; a value is written <value expr="..."/>.',
    "fa-only": "Additional arguments (thesis Table 4.1) are for an FA, whose developer knows the"
    " robot. An EA runs on any robot.",
    "not-in-unit": "A unit is one piece that nothing breaks (rule U4). A Command that works in"
    " loops is many pieces, and one that leaves the user must be able to wait for them. Handlers that"
    " a unit reaches by an event thrown in it, such as noinput, belong to it (rule U5). An expression"
    " that names the event counts as the texts that it, or the variable that it is, may give; else as"
    " any event.",
    "now-inside": "A Command wanted now cancels what the application does on its devices; inside a"
    " par, seq or iu it can only stand first.",
    "long-unit": "While a unit runs the robot reacts to nothing on its devices. Divide what it says"
    " into pieces at semantic breakpoints (thesis 4.5).",
    "shared-device": "Branches of a par that need one device cannot run at once: they run one after"
    " the other, in document order (rule U3).",
    "bad-token": "A word of a grammar cannot be said or typed: a quote that is not closed, a key that"
    " no telephone has, or in the ABNF form a question mark, which SRGS reserves (2.5).",
    "format": "The grammar is of a format that is not read: JSGF, GSL or another. SRGS is, as XML or ABNF."
    " Or its media type says the other of these two forms than it has; or none of SRGS's.",
    "language": "The grammar is in a language that whoever loads it does not take.",
    "mode": "A grammar is for voice or for dtmf, and what it refers to is of the same mode.",
    "no-root": "The grammar names no rule to begin with, and has more than one: write root on <grammar>.",
    "not-abnf": "The text is no grammar in the ABNF form of SRGS; the place is where reading stopped. Its first"
    " line is the header, #ABNF 1.0 UTF-8; and nothing else.",
    "not-fetched": "A grammar refers to another file, and whoever loads it fetches none.",
    "private-rule": "A grammar refers to a rule of another grammar that is private there. Make it public.",
    "tag-format": "tag-format names a language that is not read: semantics/1.0 and semantics/1.0-literals are.",
    "hold-price": "A stream hint (rule X3) keeps other applications out while this one waits for an event:"
    " all but their reactions wait for as long as hold-for says, after each last Command of the"
    " state. The note tells this price; it counts only in a run with the extension x3.",
    "unit-price": "While a unit runs, a reaction that needs one of its devices waits for its end. The note"
    " tells how long that may be, on the robot of the demo: what it says and its gestures; a question"
    " in it may take as long as longest says. prima validate --notes prints such notes.",
    "idle-hint": "A hint that can never have an effect: hold-for without stream, or a stream held in a"
    " state that handles no event to wait for, or that asks for no Command.",
    "endless": "The Command goes on for ever, and the state handles no event that could end it, or forms go"
    " round without waiting; another application's equal behaviours may starve (rule E4). Or what is"
    ' done about the end of a Command is a reaction (reactive="true") whose own end leads to it again:'
    " the latest reaction goes first (rule S2b), so that others' reactions are never answered.",
    "no-noinput": "A question that nobody answers is asked again, as long as nothing handles noinput. The"
    " conversation stays open meanwhile, so that nobody else can drive the robot anywhere (rule K1).",
    "leaves-question": "The robot drives away from the user in the middle of a question, and then asks it"
    " again where he is not (thesis 3.3, the Communication Channel).",
    "told-twice": "An event may come while a state says or asks something, and its handler leads back"
    " to the beginning of that state, at once or by way of others, of subdialogs that ask nothing and"
    " of further VoiceXML documents, or it goes to an item of that state which then is visited again:"
    " the same is told a second time (rule O3). Where a question is asked on the way back, or the"
    " handler keeps what the event tells, that is meant. A target that an expression names is known"
    " where the expression is a text or chooses between texts; else any state whose name begins as"
    " the expression does may be next, and the warning says that the same may be told twice.",
    "unknown-event": "A handler names an event that nothing raises, most likely a slip; given a scenario, also"
    " one of a corner that its world does not have. Events of one's own"
    " come from throw, send, link, watch, a return, or a scenario.",
    "unheard-event": "An event is raised, and no handler takes it. It is lost; one that is thrown ends the"
    " application.",
    "never-said": "A scenario waits for words that none of its applications says, so that what it holds"
    " never happens.",
    "bad-ignore": "What is to ignore a warning lacks its code or its reason: a comment in a document,"
    " <!-- prima-ignore: CODE reason -->, or an [[ignore]] of prima.toml. It ignores nothing.",
    "unused-ignore": "A comment or an [[ignore]] of prima.toml ignores a warning that is not there (any"
    " more), or that is an error: errors are never ignored. Of warnings that a document gets from a"
    " scenario alone this is not told, and of an entry only when all files that it names are checked.",
    "more-problems": "So much is wrong that only a part of it is told, errors first, and how many"
    " problems there are more. --limit problems=NUMBER raises how many are told.",
    "unsupported-command": "The robot's profile lacks the Command or one of its devices. At run"
    " time the application gets error.unsupported.COMMAND, which it may handle. It is told once of each"
    " Command of a document, with the number of places.",
}
"""Code to explanation."""
