"""Names of tongues as written in print."""


def pretty(label: str) -> str:
    """Label as written in text, with omega and indices: 2w3/5 -> 2ω₃/5."""
    digits = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
    out, after = "", False
    for character in label:
        out += character.translate(digits) if after and character.isdigit() else character.replace("w", "ω")
        after = character == "w" or (after and character.isdigit())
    return out.removesuffix("/1").replace("-", "−")
