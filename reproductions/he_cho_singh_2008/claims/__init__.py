"""The paper's claims, each judged by numbers."""
