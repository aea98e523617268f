"""Random applications and the world they meet: plays of documents, scripts for the mediator.

Two ways in. A :class:`~plays.Play` is two or three real documents, run by a session with
devices made up here. A :class:`~scripts.Script` is what two or three requesters ask of a
mediator directly. Both are plain values, so that a failing one is printed whole and can be
run again; what devices do is drawn from the play's seed and the AB's name alone, so that
shrinking one part of a play does not change the others.
"""
