"""Hard contact: a stop that gives way by nothing, and what an impact leaves.

`hard_contact` is a law's word as ``sign`` is: a force that is zero while a gap is open
and whatever keeps the gap from closing further while it is shut (the unilateral
constraint of Signorini). Where the gap shuts at a speed, the flow jumps.
"""

import sympy


class hard_contact(sympy.Function):  # type: ignore[misc]  # noqa: N801  (a law's word)
    """The force of a stop that `penetration` cannot pass.

    ``hard_contact(penetration, restitution)`` is what ``k*Max(penetration, 0)`` is for
    k without bound. Zero while the penetration is negative; at zero, the force (never
    negative) that keeps it there. At an impact the rate of penetration turns from v
    to -e v (Newton, *Principia*, 1687; as a measure law: Moreau 1988)::

        R("stop", law=hard_contact(displacement("mass") - gap, e))
        R("floor", law=-hard_contact(-displacement("ball"), e))

    Parameters
    ----------
    penetration
        An expression of displacements, parameters, inputs and t.
    restitution
        Newton's e between 0 (it stays) and 1 (nothing is lost).
    """

    nargs = 2

    def _eval_is_extended_real(self) -> bool:
        return True

    def fdiff(self, argindex: int = 1) -> sympy.Expr:
        """Return the slope while the gap is open, which is zero."""
        return sympy.S.Zero
