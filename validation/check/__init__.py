"""A model of one's own, or a record, beside both programs: verdict, misfit, and named explanations."""
