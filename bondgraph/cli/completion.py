"""``bondgraph completion``: words completed by the shell, files and models too."""

import click
from click.shell_completion import get_completion_class

from bondgraph.cli.command import Command, OneOf, json_option
from bondgraph.cli.session import Session

SHELLS = {
    "bash": 'eval "$(bondgraph completion bash)"  # in ~/.bashrc',
    "zsh": 'eval "$(bondgraph completion zsh)"  # in ~/.zshrc',
    "fish": "bondgraph completion fish > ~/.config/fish/completions/bondgraph.fish",
}
VARIABLE = "_BONDGRAPH_COMPLETE"


@click.command(
    "completion",
    cls=Command,
    examples=(
        ("completion bash > ~/.local/share/bash-completion/completions/bondgraph",
         "For bash, from the next shell on"),
        ("completion zsh >> ~/.zshrc", "For zsh"),
        ("completion fish > ~/.config/fish/completions/bondgraph.fish", "For fish"),
    ),
)  # fmt: skip
@click.argument("shell", metavar="SHELL", type=OneOf(list(SHELLS)))
@json_option
@click.pass_context
def command(ctx: click.Context, /, *, shell: str, json_file: str | None) -> None:
    """Print the text that makes SHELL complete commands, options, files and models."""
    session = ctx.ensure_object(Session)
    session.answers_in(json_file)
    kind = get_completion_class(shell)
    assert kind is not None
    text = kind(ctx.find_root().command, {}, "bondgraph", VARIABLE).source()
    session.say(text)
    session.deliver(json_file, {"schema": 1, "shell": shell, "text": text})
